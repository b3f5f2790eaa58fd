"""What can go wrong, as one tree: whoever catches `KinetreeError` catches everything kinetree raises on purpose.

KinetreeError
├── InputError                the user's input is wrong; exit code 2, never a traceback
│   ├── ConfigError           a key, a value or a path in a configuration
│   ├── FigureError           a figure or a synthetic sequence is described wrongly
│   ├── SourceError           the sequence cannot be found or listed
│   ├── MeshError             one mesh cannot be read or used
│   │   └── DisconnectedMeshError   a distance between two components was asked for
│   ├── HullError             silhouettes or a volume of one frame make no body
│   ├── StoreError            the folder is not a store, or cannot be read or written
│   │   ├── StoreFullError    no space is left on the device
│   │   ├── ReadOnlyStoreError      it may be read and not written
│   │   └── ServiceError      the service that has a bucket does not answer; exit code 3, the same command may succeed later
│   └── UnknownNodeError      no such task, node, run or artifact
├── ClusterError              the scheduler or the workers are not there; exit code 3, the same command may succeed later
├── GraphError                the declarations do not make a graph; raised at import
│   ├── TwoWritersError       two tasks return the same artifact
│   ├── MissingWriterError    an argument's type is returned by no task
│   └── CycleError            a task waits for itself
├── ArtifactError             a value breaks its schema
├── DamagedArtifactError      a stored artifact lost or changed bytes; it is computed again
├── LostWorkerError           the workers that computed a node died under it, several times
├── LateNodeError             a node took longer than its task allows, every time it was tried
├── StaleWorkerError          a worker runs other code than the one that planned
└── NodesFailedError          the run ended and some nodes failed; exit code 1
"""


class KinetreeError(Exception):
    """Root of everything kinetree raises on purpose."""


class InputError(KinetreeError):
    """The user's input is wrong; the message says where, what was found, what was expected and what to do."""


class ConfigError(InputError):
    """A key, a value or a path in a configuration."""


class FigureError(InputError):
    """A figure or a synthetic sequence is described wrongly."""


class SourceError(InputError):
    """The sequence cannot be found or listed."""


class MeshError(InputError):
    """One mesh cannot be read or used."""


class DisconnectedMeshError(MeshError):
    """A distance between two components was asked for."""


class HullError(InputError):
    """The silhouettes or the volume of one frame cannot be read, or make no body."""


class StoreError(InputError):
    """The folder is not a store, or it cannot be read or written."""


class StoreFullError(StoreError):
    """No space is left where the store lies."""


class ReadOnlyStoreError(StoreError):
    """The place of the store may be read and not written."""


class ServiceError(StoreError):
    """The service of a bucket, of the store or of the input, does not answer or failed; the same command may succeed later."""


class UnknownNodeError(InputError):
    """No such task, node, run or artifact."""


class ClusterError(KinetreeError):
    """Nobody answers at the scheduler's address, it went away, or the workers did; the same command may succeed later."""


class GraphError(KinetreeError):
    """The declarations do not make a graph; raised at import."""


class TwoWritersError(GraphError):
    """Two tasks return the same artifact."""


class MissingWriterError(GraphError):
    """An argument's type is returned by no task."""


class CycleError(GraphError):
    """A task waits for itself."""


class ArtifactError(KinetreeError):
    """A value breaks its schema."""


class DamagedArtifactError(KinetreeError):
    """A stored artifact lost or changed bytes."""

    def __init__(self, digest: str, what: str) -> None:
        super().__init__(f"artifact {digest[:12]}: {what}; it will be computed again")
        self.digest = digest
        self.what = what

    def __reduce__(self) -> tuple[type, tuple[str, str]]:
        return type(self), (self.digest, self.what)


class LostWorkerError(KinetreeError):
    """The workers that computed a node died under it, several times."""

    has_begun = True
    """Whether the node was computed when the last of them died; False where it is known that it only waited there."""


class LateNodeError(KinetreeError):
    """A node took longer than its task allows, every time it was tried."""


class StaleWorkerError(KinetreeError):
    """A worker runs other code than the one that planned."""


class NodesFailedError(KinetreeError):
    """The run ended and some nodes failed."""
