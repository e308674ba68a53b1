"""Controllers at work: rollouts, observers, masked inputs and rules fitted to decisions."""
