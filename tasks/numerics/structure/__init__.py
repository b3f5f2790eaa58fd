"""From aligned vertices to rigid parts, joints and one tree: the default of Step III."""
