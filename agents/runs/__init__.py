"""What training and tuning runs keep on disk: folders, checkpoints, seeds, provenance."""
