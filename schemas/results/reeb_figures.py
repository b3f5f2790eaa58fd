"""The chapters of a report about the steps of 2009, in the form of `StructureFigures`; no parameters."""
