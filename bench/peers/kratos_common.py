"""Meshes, parameters and runs for Kratos' implicit material point method, without a pre-processor.

A driver makes a `Scene`, calls `solve`, and prints one line of JSON: error, processor time of the
analysis (model set up and solved; not the loading of Python and of Kratos), peak memory.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

LAWS = {
    "neo": ("HyperElasticNeoHookeanPlaneStrain2DLaw", {}),
    "hencky": (  # plastic, with a cohesion that is never reached
        "HenckyMCPlasticPlaneStrain2DLaw",
        {"COHESION": 1e14, "INTERNAL_FRICTION_ANGLE": 0.5, "INTERNAL_DILATANCY_ANGLE": 0.0},
    ),
}


def arguments() -> argparse.Namespace:
    """What every driver is told."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cells", type=int, required=True)
    parser.add_argument("--steps", type=int, required=True)
    parser.add_argument("--penalty", type=float, default=100.0, help="times modulus over spacing")
    parser.add_argument("--points", type=int, default=4, help="points per cell: 1, 4, 9 or 16")
    parser.add_argument("--law", choices=LAWS, default="neo")
    parser.add_argument("--finer", type=int, default=1, help="elements of the body per cell")
    return parser.parse_args()


class Scene:
    """Background grid, body and boundaries of one analysis, and the folder for its files."""

    def __init__(self, xs: np.ndarray, ys: np.ndarray) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="kratos_"))
        self.xs, self.ys = np.asarray(xs), np.asarray(ys)
        self.nodes, self.elements = mesh(self.xs, self.ys, 0, 0)
        self.parts = {"Grid": (list(self.nodes), list(self.elements), [])}
        self.conditions: dict[int, tuple[int, int]] = {}
        self.processes: list[dict] = []
        self.n_grid = len(self.nodes)

    def hold(self, name: str, where: Callable[[float, float], bool], x: bool, y: bool) -> None:
        """Hold the grid nodes of some places."""
        found = [node for node in range(1, self.n_grid + 1) if where(*self.nodes[node])]
        self.parts[name] = (found, [], [])
        self.processes.append(
            {
                "python_module": "assign_vector_variable_process",
                "kratos_module": "KratosMultiphysics",
                "Parameters": {
                    "model_part_name": f"Background_Grid.{name}",
                    "variable_name": "DISPLACEMENT",
                    "constrained": [x, y, True],
                    "value": [0.0, 0.0, 0.0],
                    "interval": [0.0, "End"],
                },
            }
        )

    def wall(
        self,
        name: str,
        start: tuple,
        end: tuple,
        penalty: float,
        kind: str = "slip",
        increment: tuple = (0.0, 0.0),
    ) -> None:
        """A line of boundary particles with a penalty, moving by an increment in every step."""
        spacing = self.xs[1] - self.xs[0]
        n = max(1, round(math.dist(start, end) / spacing))
        nodes = []
        for k in range(n + 1):
            nodes.append(len(self.nodes) + 1)
            self.nodes[nodes[-1]] = tuple(np.add(start, np.subtract(end, start) * (k / n)))
        lines = []
        for pair in zip(nodes[:-1], nodes[1:], strict=True):
            lines.append(len(self.conditions) + 1)
            self.conditions[lines[-1]] = pair
        self.parts[name] = (nodes, [], lines)
        self.processes.append(
            {
                "python_module": "apply_mpm_particle_dirichlet_condition_process",
                "kratos_module": "KratosMultiphysics.MPMApplication",
                "Parameters": {
                    "model_part_name": f"Background_Grid.{name}",
                    "material_points_per_condition": 2,
                    "imposition_type": "penalty",
                    "penalty_coefficient": penalty,
                    "variable_name": "DISPLACEMENT",
                    "constrained": kind,
                    "value": [*increment, 0.0],
                    "interval": [0.0, 1e30],
                    "is_equal_distributed": False,
                    "option": "",
                },
            }
        )

    def body(self, across: int, up: int, place: Callable, law: dict) -> None:
        """A body as a mesh of the unit square, put into its place; the law with its constants."""
        nodes, elements = mesh(
            np.linspace(0, 1, across + 1),
            np.linspace(0, 1, up + 1),
            len(self.nodes),
            len(self.elements),
        )
        nodes = {number: place(*at) for number, at in nodes.items()}
        parts = {"Solid": (list(nodes), list(elements), [])}
        write_mesh(self.folder / "Body.mdpa", nodes, elements, {}, parts, 1)
        write_mesh(
            self.folder / "Grid.mdpa", self.nodes, self.elements, self.conditions, self.parts, 0
        )
        name, constants = LAWS[law.pop("law")]
        properties = {
            "model_part_name": "Initial_MPM_Material.Solid",
            "properties_id": 1,
            "Material": {
                "constitutive_law": {"name": name},
                "Variables": {"THICKNESS": 1.0, **law, **constants},
                "Tables": {},
            },
        }
        (self.folder / "materials.json").write_text(json.dumps({"properties": [properties]}))


def constants(law: str, modulus: float, ratio: float, density: float, points: int) -> dict:
    """Constants of a law under the names of Kratos."""
    return {
        "law": law,
        "YOUNG_MODULUS": modulus,
        "POISSON_RATIO": ratio,
        "DENSITY": density,
        "MATERIAL_POINTS_PER_ELEMENT": points,
    }


def mesh(xs: np.ndarray, ys: np.ndarray, first_node: int, first_element: int) -> tuple:
    """Nodes and quadrilaterals of a grid of lines."""
    n = len(xs)
    nodes = {
        first_node + 1 + j * n + i: (x, y) for j, y in enumerate(ys) for i, x in enumerate(xs)
    }
    elements = {}
    for j in range(len(ys) - 1):
        for i in range(n - 1):
            k = first_node + 1 + j * n + i
            elements[first_element + len(elements) + 1] = (k, k + 1, k + n + 1, k + n)
    return nodes, elements


def write_mesh(
    path: Path, nodes: dict, elements: dict, conditions: dict, parts: dict, properties: int
) -> None:
    """A file of Kratos' mdpa format."""
    out = ["Begin ModelPartData", "End ModelPartData"]
    for number in range(properties + 1):
        out += [f"Begin Properties {number}", "End Properties"]
    out.append("Begin Nodes")
    out += [f"{k} {x:.15g} {y:.15g} 0" for k, (x, y) in nodes.items()]
    out += ["End Nodes", "Begin Elements Element2D4N"]
    out += [f"{k} {properties} {' '.join(map(str, corners))}" for k, corners in elements.items()]
    out.append("End Elements")
    if conditions:
        out.append("Begin Conditions LineCondition2D2N")
        out += [f"{k} 0 {a} {b}" for k, (a, b) in conditions.items()]
        out.append("End Conditions")
    for name, lists in parts.items():
        out.append(f"Begin SubModelPart {name}")
        for kind, numbers in zip(("Nodes", "Elements", "Conditions"), lists, strict=True):
            out.append(f"Begin SubModelPart{kind}")
            out += [str(number) for number in numbers]
            out.append(f"End SubModelPart{kind}")
        out.append("End SubModelPart")
    path.write_text("\n".join(out) + "\n")


def parameters(scene: Scene, steps: int) -> dict:
    """Settings of a quasi-static analysis with Newton's method and a direct solver."""
    folder = scene.folder
    return {
        "problem_data": {
            "problem_name": "bench",
            "parallel_type": "OpenMP",
            "echo_level": 0,
            "start_time": 0.0,
            "end_time": steps - 0.5,
        },
        "solver_settings": {
            "solver_type": "Quasi-static",
            "scheme_type": "newmark",
            "model_part_name": "MPM_Material",
            "domain_size": 2,
            "echo_level": 0,
            "analysis_type": "non_linear",
            "time_integration_method": "implicit",
            "model_import_settings": {
                "input_type": "mdpa",
                "input_filename": str(folder / "Body"),
            },
            "grid_model_import_settings": {
                "input_type": "mdpa",
                "input_filename": str(folder / "Grid"),
            },
            "material_import_settings": {"materials_filename": str(folder / "materials.json")},
            "time_stepping": {"time_step": 1.0},
            "convergence_criterion": "residual_criterion",
            "residual_relative_tolerance": 1e-6,
            "residual_absolute_tolerance": 1e-9,
            "max_iteration": 30,
            "pressure_dofs": False,
            "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"},
            "auxiliary_variables_list": ["NORMAL", "NODAL_AREA", "IS_STRUCTURE"],
        },
        "processes": {
            "constraints_process_list": scene.processes,
            "loads_process_list": [],
            "list_other_processes": [],
            "gravity": [],
        },
        "output_processes": {},
    }


def solve(scene: Scene, steps: int, acceleration: tuple | None = None) -> dict:
    """Run all steps, an acceleration growing with them; the points as arrays, and the cost."""
    import KratosMultiphysics as kratos
    import KratosMultiphysics.LinearSolversApplication
    import KratosMultiphysics.MPMApplication as mpm
    from KratosMultiphysics.MPMApplication.mpm_analysis import MpmAnalysis

    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    start = time.process_time()
    settings = kratos.Parameters(json.dumps(parameters(scene, steps)))
    analysis = MpmAnalysis(kratos.Model(), settings)
    analysis.Initialize()
    part = analysis.GetComputingModelPart()
    for step in range(1, steps + 1):
        analysis.time = analysis._AdvanceTime()
        if acceleration:
            load = kratos.Array3([step / steps * a for a in (*acceleration, 0.0)])
            for element in part.Elements:
                element.SetValuesOnIntegrationPoints(
                    mpm.MP_VOLUME_ACCELERATION, [load], part.ProcessInfo
                )
        analysis.InitializeSolutionStep()
        if not analysis.SolveSolutionStep():
            sys.exit(f"step {step} of {steps} does not converge")
        analysis.FinalizeSolutionStep()
    cost = time.process_time() - start
    data = {"cpu": cost, "part": part}
    for name in ("COORD", "CAUCHY_STRESS_VECTOR", "VOLUME", "MASS", "DISPLACEMENT"):
        variable = kratos.KratosGlobals.GetVariable(f"MP_{name}")
        data[name.lower()] = np.array(
            [
                np.array(element.CalculateOnIntegrationPoints(variable, part.ProcessInfo)[0])
                for element in part.Elements
            ]
        )
    return data


def report(data: dict, error: float) -> None:
    """The line that the benchmark reads."""
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print("RESULT", json.dumps({"error": error, "cpu": data["cpu"], "memory": memory}))
