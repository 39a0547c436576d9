"""Reads exported frames with the readers other people have written, and holds what they see against the CSV of the same frame.

    python3 readers.py FOLDER NUMBER LINK READER...

FOLDER has frame-NUMBER.* of a three-dimensional run. Prints a line for each reader that agrees.
"""

import csv
import sys
from pathlib import Path

import numpy as np

folder, number, link = Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])


def path(ending):
    return str(folder / f"frame-{number}.{ending}")


with open(path("csv"), newline="") as file:
    rows = list(csv.DictReader(file))
truth = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
positions = np.stack([truth[axis] for axis in "xyz"], axis=1)
velocities = np.stack([truth["v" + axis] for axis in "xyz"], axis=1)
gradients = np.stack([truth[f"f{i}{j}"] for i in "xyz" for j in "xyz"], axis=1)
SINGLE = 2e-7


def close(found, expected, relative=SINGLE):
    found, expected = np.asarray(found, dtype=float), np.asarray(expected)
    assert found.shape == expected.shape, (found.shape, expected.shape)
    assert np.abs(found - expected).max() <= relative * max(1e-30, np.abs(expected).max())


def partition(labels):
    """The label of each particle by the first particle that has it."""
    _, first, inverse = np.unique(np.asarray(labels), return_index=True, return_inverse=True)
    return first[inverse]


def plyfile():
    from plyfile import PlyData

    vertices = PlyData.read(path("ply"))["vertex"]
    close(np.stack([vertices[axis] for axis in "xyz"], axis=1), positions)
    close(np.stack([vertices["v" + axis] for axis in "xyz"], axis=1), velocities)
    close(vertices["jp"], truth["jp"])
    close(vertices["mass"], truth["mass"])
    assert (vertices["id"] == truth["id"]).all() and vertices["fragment"].min() == 1


def meshio():
    import meshio

    mesh = meshio.read(path("ply"))
    close(mesh.points, positions)
    close(mesh.point_data["jp"], truth["jp"])


def vtk():
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path("vtp"))
    reader.Update()
    data = reader.GetOutput()
    assert data.GetNumberOfVerts() == len(rows)
    close(vtk_to_numpy(data.GetPoints().GetData()), positions, 1e-15)

    def field(name):
        return vtk_to_numpy(data.GetPointData().GetArray(name))

    close(field("velocity"), velocities)
    close(field("deformation"), gradients)
    close(field("jp"), truth["jp"])
    # tau of S13's energy, by hand: 2 mu (F - R) F^T + lambda (J - 1) J, with R of the polar decomposition.
    young, poisson, hardening = 1.4e5, 0.2, 10.0
    mu, lame = young / (2 + 2 * poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    f = gradients.reshape(-1, 3, 3)
    u, _, vt = np.linalg.svd(f)
    j = np.linalg.det(f)
    scale = np.exp(hardening * (1 - truth["jp"]))[:, None, None]
    spherical = (lame * (j - 1) * j)[:, None, None] * np.eye(3)
    tau = scale * (2 * mu * (f - u @ vt) @ f.transpose(0, 2, 1) + spherical)
    # Over the volume as it is: that at rest, times J_E J_P.
    close(field("stress"), (tau / (j * truth["jp"])[:, None, None]).reshape(-1, 9), 1e-4)
    time = data.GetFieldData().GetArray("TimeValue").GetValue(0)
    assert time > 0


def pvd():
    import xml.etree.ElementTree as tree

    sets = tree.parse(folder / "frames.pvd").getroot().iter("DataSet")
    series = [(float(entry.get("timestep")), entry.get("file")) for entry in sets]
    assert series == sorted(series) and all((folder / name).is_file() for _, name in series)
    assert len(series) == len(list(folder.glob("*.vtp"))) > 1


def ase():
    from ase.io import read

    atoms = read(path("xyz"), format="extxyz")
    close(atoms.positions, positions, 1e-15)
    close(atoms.arrays["velo"], velocities, 1e-15)
    assert (atoms.arrays["id"] == truth["id"]).all() and not atoms.pbc.any()


def ovito():
    from ovito.io import import_file
    from ovito.modifiers import ClusterAnalysisModifier

    pipeline = import_file(path("xyz"))
    pipeline.modifiers.append(ClusterAnalysisModifier(cutoff=link, sort_by_size=True))
    particles = pipeline.compute().particles
    close(np.asarray(particles.positions), positions, 1e-15)
    ours, theirs = np.asarray(particles["fragment"]), np.asarray(particles["Cluster"])
    assert len(np.unique(theirs)) == ours.max() > 3, (np.unique(theirs), ours.max())
    assert (partition(ours) == partition(theirs)).all()
    # Both count the largest first; OVITO 3.17 begins with 0.
    assert (theirs - theirs.min() + 1 == ours).all()


def mitsuba():
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    values = np.array(mitsuba.VolumeGrid(path("vol"))).astype(float)
    texture = {"type": "gridvolume", "filename": path("vol"), "use_grid_bbox": True}
    box = mitsuba.load_dict(texture).bbox()
    values = values.reshape(values.shape[:3])
    # z first, x last.
    cell = (np.array(box.max) - np.array(box.min)) / np.array(values.shape[::-1])
    unit = truth["mass"].sum() / truth["volume"].sum()
    close([values.sum() * unit * cell.prod()], [truth["mass"].sum()], 1e-5)
    axes = [np.array(box.min)[k] + cell[k] * (np.arange(values.shape[2 - k]) + 0.5) for k in range(3)]
    centre = [(values.sum(axis=tuple({0, 1, 2} - {2 - k})) * axes[k]).sum() / values.sum() for k in range(3)]
    expected = (truth["mass"][:, None] * positions).sum(axis=0) / truth["mass"].sum()
    assert np.abs(np.array(centre) - expected).max() < 1e-5


def openvdb():
    import pyopenvdb

    grid = pyopenvdb.read(path("vdb"), "density")
    cell = grid.transform.voxelSize()[0]
    values = {(i, j, k): value for i, j, k, value in voxels(grid)}
    unit = truth["mass"].sum() / truth["volume"].sum()
    close([sum(values.values()) * unit * cell**3], [truth["mass"].sum()], 1e-5)
    nodes, weights = np.array(list(values)), np.array(list(values.values()))
    centre = cell * (nodes * weights[:, None]).sum(axis=0) / weights.sum()
    expected = (truth["mass"][:, None] * positions).sum(axis=0) / truth["mass"].sum()
    assert np.abs(centre - expected).max() < 1e-5
    assert grid.gridClass == "fog volume" and grid.activeVoxelCount() == len(values)


def voxels(grid):
    for item in grid.citerOnValues():
        (i, j, k), (x, y, z) = item.min, item.max
        for a in range(i, x + 1):
            for b in range(j, y + 1):
                for c in range(k, z + 1):
                    yield a, b, c, item.value


def pyarrow():
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path("parquet"))
    close(np.stack([table[axis].to_numpy() for axis in "xyz"], axis=1), positions, 1e-15)
    close(table["velocity_y"].to_numpy(), truth["vy"])
    close(table["deformation_xy"].to_numpy(), truth["fxy"])
    assert (table["id"].to_numpy() == truth["id"]).all()


def duckdb():
    import duckdb

    [(count, mass)] = duckdb.sql(f"select count(*), sum(mass) from '{path('parquet')}'").fetchall()
    assert count == len(rows)
    close([mass], [truth["mass"].sum()])


def numpy():
    """The film as docs/frames.md tells to read it."""
    import json

    raw = (folder / "frames.snowlab").read_bytes()
    assert raw[:16] == b"snowlab-frames-2"
    length = int.from_bytes(raw[16:24], "little")
    header = json.loads(raw[24 : 24 + length])
    kinds = {"u32": "<u4", "f32": "<f4", "f64": "<f8"}

    def layout(arrays):
        shape = lambda array: (header["particles"], len(array["components"]))
        return [(array["name"], kinds[array["kind"]], shape(array)) for array in arrays]

    constants = np.dtype(layout(header["constants"]))
    frame = np.dtype([("time", "<f8")] + layout(header["fields"]))
    start = 24 + length + constants.itemsize
    fixed = np.frombuffer(raw, constants, count=1, offset=24 + length)[0]
    frames = np.frombuffer(raw, frame, count=(len(raw) - start) // frame.itemsize, offset=start)
    one = frames[int(number)]
    close(one["position"] + header["origin"], positions)
    close(one["velocity"], velocities)
    close(one["deformation"], gradients)
    close(fixed["mass"][:, 0], truth["mass"], 1e-15)
    assert "spacing" in header["scene"]


for reader in sys.argv[4:]:
    globals()[reader]()
    print(f"{reader} agrees")
