"""Files and rules that training and tuning runs share: folders, checkpoints, seeds, provenance."""
