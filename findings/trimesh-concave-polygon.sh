#!/usr/bin/env bash
# trimesh cuts a concave polygon of an OBJ file into a fan that covers up to three times its area.
#
# Guess: a face of four corners whose border turns inward is cut into the two triangles inside of it, so that the
# area of the mesh is that of the polygon (4 square units here), whichever corner the file names first.
# Seen with trimesh 5.2.0 (Python 3.11): the fan from the first corner whatever the shape: 12 square units, and with
# the inward corner named first 4. Where polygons are occluders, the fan hides what the polygon leaves open.
set -euo pipefail
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/env"
"$here/env/bin/pip" --quiet install trimesh==5.2.0 numpy==2.4.6

cat > "$here/try.py" <<'PY'
import sys
import trimesh

# An arrow head: corner 3 lies inside of the triangle of the others.
corners = "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\n"
areas = {}
for first, face in {"outer corner": "f 2 3 4 1\n", "inward corner": "f 3 4 1 2\n"}.items():
    path = f"{sys.argv[1]}/arrow.obj"
    with open(path, "w") as file:
        file.write(corners + face)
    mesh = trimesh.load_mesh(path)
    areas[first] = (len(mesh.faces), round(float(mesh.area), 6))
print("trimesh", trimesh.__version__, "triangles and area:", areas, "(the polygon has 4)")
assert areas == {"outer corner": (2, 12.0), "inward corner": (2, 4.0)}, "the behavior has changed"
PY
"$here/env/bin/python" "$here/try.py" "$here"
