"""What clusters cost and bring: measured on logical nodes of this machine, predicted for larger ones."""
