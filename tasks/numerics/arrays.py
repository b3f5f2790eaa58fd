"""Types of arrays, by what they hold."""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.uint32]
Lengths = npt.NDArray[np.float32]
Labels = npt.NDArray[np.int32]
Faces = npt.NDArray[np.int32]
