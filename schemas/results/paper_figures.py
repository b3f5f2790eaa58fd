"""What the task gives is `Evidence`, as the default's is: chapters of a report, on the paper's own steps."""
