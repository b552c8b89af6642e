"""The Khronos glTF validator (npm module gltf-validator) on our model files, where node and the module are at hand.

Nothing is ever installed or fetched: the module is looked for where node itself looks (``node_modules`` of the working
folder and above, ``NODE_PATH``) and among the global modules beside the node program.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from game.core.errors import MissingPart

__all__ = ["GltfFinding", "validate"]

TIMEOUT_S = 180.0
HOW = "install it where node finds it: npm install -g gltf-validator"
_SCRIPT = """
const path = require("path"), fs = require("fs"), module_ = require("module");
const home = path.dirname(process.execPath);
process.env.NODE_PATH = [process.env.NODE_PATH, path.join(home, "..", "lib", "node_modules"),
  path.join(home, "node_modules")].filter(Boolean).join(path.delimiter);
module_.Module._initPaths();
let validator;
try { validator = require("gltf-validator"); } catch (error) { process.exit(3); }
(async () => {
  const reports = [];
  for (const file of process.argv.slice(1)) {
    const bytes = new Uint8Array(fs.readFileSync(file));
    const report = await validator.validateBytes(bytes, {maxIssues: 1000, writeTimestamp: false});
    reports.push(report.issues.messages.filter((issue) => issue.severity <= 1));
  }
  process.stdout.write(JSON.stringify(reports));
})().catch((error) => { process.stderr.write(String(error)); process.exit(4); });
"""
_SEVERITY = ("error", "warning")


@dataclass(frozen=True)
class GltfFinding:
    """severity: error or warning. pointer: JSON pointer into the file's JSON, empty where the validator gives none."""

    path: Path
    severity: str
    code: str
    pointer: str
    message: str

    def __str__(self) -> str:
        return f"{self.path}:{self.pointer}: {self.severity} {self.code} {self.message}".replace("\n", " ")


def validate(files: Sequence[Path]) -> list[GltfFinding]:
    """Errors and warnings of all files, in order. Raises MissingPart, one line, where node or the module is absent."""
    node = shutil.which("node")
    if node is None:
        raise MissingPart(f"gltf-validator did not run: no node on the path; {HOW}")
    command = [node, "-e", _SCRIPT, *(str(path) for path in files)]
    try:
        done = subprocess.run(command, capture_output=True, timeout=TIMEOUT_S, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise MissingPart(f"gltf-validator did not run: {type(error).__name__}") from error
    if done.returncode == 3:
        raise MissingPart(f"gltf-validator did not run: node has no module gltf-validator; {HOW}")
    if done.returncode:
        reason = done.stderr.decode("utf-8", "replace").strip().splitlines()
        raise MissingPart(
            f"gltf-validator did not run: {reason[-1][:160] if reason else f'exit code {done.returncode}'}"
        )
    reports = json.loads(done.stdout)
    return [
        GltfFinding(path, _SEVERITY[issue["severity"]], issue["code"], issue.get("pointer", ""), issue["message"])
        for path, issues in zip(files, reports, strict=True)
        for issue in issues
    ]
