"""Presets that ship with kinetree, one YAML file each."""
