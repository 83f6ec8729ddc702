"""Several bodies with several laws in one deck, and the state of the laws in the results."""
import os
import subprocess
from pathlib import Path

import h5py
import numpy as np

PROGRAM = Path(os.environ.get("COULTER_PROGRAM") or "build/release/coulter").resolve()

# two blocks side by side on one base under one plate: clay flows, rock does not; a bed is held
DECK = """
&scene stress_unit = 'kPa' /
&grid origin = -1.0, -1.0, spacing = 0.5, cells = 24, 8 /
&law name = 'soft', model = 'tresca', youngs_modulus = 1000.0, poisson_ratio = 0.49,
   shear_strength = 3.0, strength_gradient = 1.0, strength_datum = 3.0 /
&law name = 'stiff', youngs_modulus = 1000.0, poisson_ratio = 0.49 /
&law name = 'dense', model = 'cam_clay', compression_index = 0.1, swelling_index = 0.02,
   shear_ratio = 50.0, critical_ratio = 1.0, overconsolidation = 2.0 /
&body name = 'clay', law = 'soft', density = 0.0 /
&body name = 'rock', law = 'stiff', density = 0.0 /
&body name = 'bed', law = 'dense', density = 0.0, initial_stress = -9.0, -9.0, -9.0, 0.0 /
&region body = 'clay', rectangle = 0.0, 0.0, 1.0, 2.0 /
&region body = 'rock', rectangle = 4.0, 0.0, 5.0, 2.0 /
&region body = 'bed', rectangle = 8.0, 0.0, 9.0, 2.0 /
&boundary name = 'base', kind = 'roller', bilateral = .true., vertices = 0.0, 0.0, 9.0, 0.0 /
&boundary name = 'plate', kind = 'roller', vertices = 6.0, 2.0, -0.5, 2.0,
   displacement = 0.0, -0.06 /
&boundary name = 'left', kind = 'roller', bilateral = .true., vertices = 0.0, 2.0, 0.0, 0.0 /
&boundary name = 'near', kind = 'roller', bilateral = .true., vertices = 4.0, 2.0, 4.0, 0.0 /
&boundary name = 'w', kind = 'fixed', bilateral = .true., vertices = 8.0, 2.0, 8.0, 0.0 /
&boundary name = 'e', kind = 'fixed', bilateral = .true., vertices = 9.0, 0.0, 9.0, 2.0 /
&boundary name = 'n', kind = 'fixed', bilateral = .true., vertices = 9.0, 2.0, 8.0, 2.0 /
&control hourglass = 0.1 /
&steps count = 4 /
"""


def test_laws_side_by_side(tmp_path):
    deck = tmp_path / "laws.nml"
    deck.write_text(DECK)
    result = subprocess.run([PROGRAM, "--output", tmp_path, deck], capture_output=True, text=True,
                            timeout=120, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    with h5py.File(tmp_path / "laws.vtkhdf") as file:
        first = file["VTKHDF/Steps/PointOffsets"][-1]
        fields = {name: data[first:first + file["VTKHDF/NumberOfPoints"][-1]]
                  for name, data in file["VTKHDF/PointData"].items()}
        assert file["VTKHDF/PointData/strength"].attrs["unit"] in ("kPa", b"kPa")
        y = file["VTKHDF/Points"][first:first + len(fields["body"]), 1] \
            - fields["displacement"][:, 1]
    clay, rock, bed = (fields["body"] == k for k in (1, 2, 3))
    # the strength grows with depth: the upper half flows
    flows = clay & (fields["plastic_strain"] > 0.0)
    assert flows.any() and np.all(y[flows] > 0.5)
    assert not np.any(fields["plastic_strain"][rock | bed])
    # strength by depth, at the points where they started
    np.testing.assert_allclose(fields["strength"][clay], 6.0 - y[clay], rtol=1e-12)
    assert not np.any(fields["strength"][rock | bed])
    # Tresca: J times the difference of principal stresses is twice the strength at the point
    stress = fields["stress"] * fields["volume_ratio"][:, None]
    radius = np.hypot(0.5 * (stress[:, 0] - stress[:, 1]), stress[:, 3])
    np.testing.assert_allclose(radius[flows], fields["strength"][flows], rtol=1e-9)
    assert np.all(radius[clay & ~flows] < fields["strength"][clay & ~flows])
    # under plane strain the elastic block carries E/(1 - nu^2) ln s
    expected = 1000.0 / (1 - 0.49**2) * np.log(1.94 / 2.0)
    np.testing.assert_allclose(stress[rock, 1], expected, rtol=1e-6)
    # the held bed keeps stress and preconsolidation
    np.testing.assert_allclose(fields["preconsolidation"][bed], 18.0, rtol=1e-9)
    np.testing.assert_allclose(fields["stress"][bed, 1], -9.0, rtol=1e-6)
