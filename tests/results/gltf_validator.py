"""What the Khronos validator says of a GLB."""

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

MODULES = Path(__file__).resolve().parents[2] / ".venv" / "node_modules"
VALIDATE = """
const validator = require("gltf-validator");
validator.validateBytes(new Uint8Array(require("fs").readFileSync(process.argv[2])), {maxIssues: 20})
  .then((told) => console.log(JSON.stringify(told.issues)));
"""


def issues(path: Path) -> dict[str, Any]:
    """Its issues; skips the test where it is not installed."""
    environment = {**os.environ, "NODE_PATH": os.pathsep.join([str(MODULES), os.environ.get("NODE_PATH", "")])}
    node = shutil.which("node")
    there = node and subprocess.run([node, "-e", 'require("gltf-validator")'], env=environment, capture_output=True)
    if node is None or there is None or there.returncode:
        pytest.skip("npm install gltf-validator brings the Khronos validator")
    script = path.with_name("validate.js")
    script.write_text(VALIDATE)
    done = subprocess.run([node, str(script), str(path)], env=environment, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout))
