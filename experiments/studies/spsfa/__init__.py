"""The study of the SPSFA paper (Li, Fan, Hou 2020)."""
