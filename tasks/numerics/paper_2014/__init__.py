"""The 2014 paper to the letter: geodesic coordinates, ARAP, cones, annuli, kinematic cones and cylinders (Sec. 5 and 6)."""
