"""Synthetic 3D video with a true skeleton: figures, their motion, the surfaces a reconstruction would make of them."""
