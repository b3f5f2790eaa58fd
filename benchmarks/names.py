"""How many joints of generated people have their right names, and how many a wrong side.

    python benchmarks/names.py [--seeds 6] [--frames 24] [--vertices 4000] [--work FOLDER]

Each person is computed from its meshes, with other proportions for every seed; walking, waving and squatting take turns. A
found joint is one that the evaluation pairs with a scored true joint; its name is right if it is that of the true joint. The
law: at least 95 % right, and no wrong side without a warning.
"""

import argparse
import tempfile
from pathlib import Path
from typing import Any

import yaml
from accuracy import MOTIONS, varied

from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.structure.joint_names import CERTAIN_FRONT

TRUE = {"hips": "pelvis"}
"""Names of true joints that differ from those of `joint_names`."""


def measured(seed: int, motion: str, frames: int, vertices: int, work: Path) -> tuple[list[tuple[str, str]], Any]:
    """True and given name of every found joint, and the names."""
    path = work / f"human-{seed}.yaml"
    path.write_text(yaml.safe_dump(varied("human", seed)))
    synth = {"file": str(path), "motion": motion, "seed": seed, "frames": frames, "vertices": vertices}
    pipeline = Pipeline.of({"source": {"synth": synth}, "output": str(work / f"human-{seed}"), "store": str(work / "store")})
    pipeline.run(until=["evaluation", "joint_names"])
    there = pipeline.inspect()
    names, evaluation = there.artifact("joint_names"), there.artifact("evaluation")
    name_of = dict(zip(names.given, names.names, strict=True))
    scored = [joint for joint in evaluation.joints if joint.scored and joint.found]
    return [(TRUE.get(joint.name, joint.name), name_of[joint.found]) for joint in scored], names


def main() -> None:
    """Prints a line a person, then the sums."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--vertices", type=int, default=4000)
    parser.add_argument("--work", type=Path)
    args = parser.parse_args()
    right, total, silent = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        work = args.work or Path(folder)
        work.mkdir(parents=True, exist_ok=True)
        for seed in range(args.seeds):
            motion = MOTIONS["human"][seed % len(MOTIONS["human"])]
            pairs, names = measured(seed, motion, args.frames, args.vertices, work)
            wrong = [(true, name) for true, name in pairs if true != name]
            exchanged = [pair for pair in wrong if {pair[0][-2:], pair[1][-2:]} == {"_l", "_r"}]
            silent += len(exchanged) if names.front_confidence >= CERTAIN_FRONT else 0
            good = len(pairs) - len(wrong)
            right, total = right + good, total + len(pairs)
            print(f"human-{seed} {motion:6s} {good} of {len(pairs)} right", *(f"{a} is {b}" for a, b in wrong), flush=True)
    share = 100 * right / max(total, 1)
    print(f"{right} of {total} found joints right ({share:.1f} %), wrong sides without a warning: {silent}")


if __name__ == "__main__":
    main()
