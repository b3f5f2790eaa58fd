"""What kinetree is to the loom: its methods, presets and commands. Cheap to import."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NoReturn

from kinetree.pipeline.application import Application, Command, Section, Shortcut, built_in
from kinetree.pipeline.command_line.cli import main as run_command_line

if TYPE_CHECKING:
    from kinetree.pipeline.graph import Graph


def _methods() -> "Mapping[str, Graph]":
    from kinetree.pipeline.graph_cache import kept_graphs

    return kept_graphs("kinetree.tasks.methods:METHODS")


def _data_sets() -> "Graph":
    from kinetree.pipeline.graph_cache import kept_graphs

    return kept_graphs("kinetree.tasks.methods:DATA_SETS")[""]


def _command(name: str, summary: str, *examples: str) -> Command:
    """A command of our own, in the file of its name."""
    return Command(name, summary, f"kinetree.tasks.commands.{name}:{name}", examples)


APPLICATION = Application(
    name="kinetree",
    summary="Kinematic structure of a moving body from 3D video: a tree of joints and bones from meshes whose vertices and"
    " connectivity change in every frame.",
    methods=_methods,
    presets="kinetree.configs",
    data_sets=_data_sets,
    sections=(
        Section(
            "Start",
            (
                _command(
                    "demo",
                    "Compute an example and say where the results are.",
                    "kinetree demo",
                    "kinetree demo --output walk-demo",
                ),
                built_in("run", "kinetree run --input scans/ --output walk/", "kinetree run walk.yaml --until mesh"),
                _command(
                    "view",
                    "Open the report of a run in a browser.",
                    "kinetree view walk/",
                    "kinetree view walk/ --print",
                ),
            ),
        ),
        Section(
            "Many sequences",
            (
                built_in(
                    "dataset",
                    "kinetree dataset plan lab.yaml",
                    "kinetree dataset run lab.yaml --max-hours 6",
                    "kinetree dataset run lab.yaml --only 'walk_*' --failed",
                    "kinetree dataset status lab.yaml --json",
                ),
            ),
        ),
        Section(
            "Look",
            (
                built_in("show", 'kinetree show "mesh[frame=3]" walk/', "kinetree show skeleton walk/"),
                built_in("plan", "kinetree plan walk.yaml", "kinetree plan walk/ --set mesh.component_share=0.1 --json"),
                built_in("why", 'kinetree why "mesh[frame=3]" walk/', "kinetree why leaves walk/"),
                built_in("graph", "kinetree graph", "kinetree graph walk/ --format dot | dot -Tsvg > graph.svg"),
                built_in("tasks", "kinetree tasks --json"),
                built_in("runs", "kinetree runs walk/"),
                built_in("diff", "kinetree diff 20250301-081500-123ab 20250302-081500-4560c walk/"),
            ),
        ),
        Section(
            "Take away",
            (
                _command(
                    "export",
                    "Write the result of a run as a file for other programs.",
                    "kinetree export walk/ --to csv",
                    "kinetree export walk/ --to glb -o walk.glb --set glb.scale=0.001",
                    "kinetree export walk/ --to ply -o coloured/",
                    "kinetree export walk/ --to bvh --names mixamo",
                    "kinetree export walk/ --to names -o names.yaml",
                ),
                _command(
                    "plot",
                    "Draw a result of a run: curves, surfaces, the tree, errors.",
                    "kinetree plot walk/ correlation -o correlation.pdf",
                    "kinetree plot walk/ mu --frames 0,12,30",
                ),
                _command(
                    "evaluate",
                    "Compare the skeleton of a run with the true one, joint by joint.",
                    "kinetree evaluate walk/ walk/truth.json",
                    "kinetree evaluate walk/ dance.bvh --set truth.unit=cm",
                    "kinetree evaluate walk/ other-run/skeleton.json --plot errors.png",
                ),
                _command(
                    "compare",
                    "Compare two runs of the same sequence: joints, errors, parameters.",
                    "kinetree compare walk/ walk-paper/",
                    "kinetree compare walk/ walk-paper/ --truth truth.json --output comparison.html",
                ),
                _command(
                    "reproduce",
                    "Make the tables and figures of the 2014 paper, by its preset and by the default.",
                    "kinetree reproduce 2014 --table 1 --figure 11",
                    "kinetree reproduce 2014 --table 2 --input walk/ --truth walk/truth.json",
                ),
            ),
        ),
        Section("Configure", (built_in("config", "kinetree config > walk.yaml", "kinetree config paper-2014"),)),
        Section(
            "Make",
            (
                _command(
                    "synth",
                    "Write a synthetic sequence with its true skeleton.",
                    "kinetree synth human -o walk/",
                    "kinetree synth quadruped -o dog/ --frames 60 --vertices 12000",
                    "kinetree synth human -o hip/ --contact hand_r:hip_r:12:26 --noise 0.001",
                ),
                _command(
                    "silhouettes",
                    "Render the silhouettes of a mesh sequence from a ring of cameras.",
                    "kinetree silhouettes walk/ -o walk-masks/",
                    "kinetree silhouettes walk/ -o walk-masks/ --cameras 8 --size 1024 --up z",
                ),
                _command(
                    "convert",
                    "Let Blender make a sequence of an FBX, Alembic, Collada, X3D or Blender file.",
                    "kinetree convert walk.fbx",
                    "kinetree convert walk.blend -o walk.npz --blender /opt/blender/blender",
                    "kinetree convert cloth.abc --blender ~/bpy/bin/python",
                ),
            ),
        ),
        Section(
            "Care",
            (
                built_in("gc", "kinetree gc walk/ --dry-run", "kinetree gc walk/ --keep-days 30 --max-size 20GB"),
                built_in("verify", "kinetree verify walk/", "kinetree verify walk/ --repair"),
            ),
        ),
    ),
    shortcuts=(
        Shortcut(
            ("--input", "-i"),
            "source.input",
            "Folder or glob of meshes, silhouettes or volumes, one per frame, or one file with all frames; meshes also at s3://.",
            "FOLDER",
            is_input=True,
        ),
        Shortcut(("--frames",), "source.frames", "Which frames to use, e.g. 10:60:2.", "START:STOP:STEP"),
        Shortcut(
            ("--names",),
            "joint_names.style",
            "How files call the joints: kinetree, mixamo, smpl, openpose, vrm, isb or none.",
            "STYLE",
        ),
    ),
    renamed={
        "articulation": "kinematic_tree",
        "consistency": "cone_consistency",
        "distribution": "mu_histogram",
        "matching": "geodesic_mapping",
        "parts": "rigid_parts",
        "excerpt.input_vertices": "coarse_mesh.vertices",
        "report.frames": "excerpt.frames",
        "report.input_vertices": "coarse_mesh.vertices",
        "report.up": "up_direction.up",
        "report.vertices": "played_body.vertices",
        "report.views": "excerpt.views",
        "rigid_parts.missed": "rigid_parts.removal_cost",
        "skeleton": "kinematic_tree",
        "template": "deformation_graph",
        "tips": "extrema",
        "upright": "up_direction",
    },
    beside="kinetree.tasks.compiled_ahead:compiling_ahead",
    worker_setup="kinetree.tasks.worker_setup:load",
    first_steps=(
        ("kinetree demo", "compute an example, in a few minutes"),
        ("kinetree run --input FOLDER --output OUT", "compute your own sequence: a folder of meshes, one per frame"),
        ("kinetree view OUT", "look at the result"),
    ),
)


def main() -> NoReturn:
    """The command `kinetree`."""
    run_command_line(APPLICATION)
