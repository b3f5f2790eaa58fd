"""The task leaves `StructureFigures`, as the default method's does: chapters of a report about the steps of 2014."""
