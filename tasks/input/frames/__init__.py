"""Frames as the user gave them: where they lie, what each surface measures, and what each holds."""
