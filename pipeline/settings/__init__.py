"""What the user says: configurations, presets, overrides."""
