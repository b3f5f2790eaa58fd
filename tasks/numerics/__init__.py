"""Numerics: arrays in, arrays out; nothing here knows how a result is scheduled or stored."""
