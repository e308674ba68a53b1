"""Logs of runs on BBOB functions, in the formats that cocopp and IOHanalyzer read."""
