#!/usr/bin/env bash
# trimesh places a skinned glTF mesh by the transform of its own node.
#
# Guess: a reader of glTF that has no skins shows a skinned mesh at rest where its joints hold it, or says that it
# does not. glTF 2.0, Section 3.7.3: the transform of the node that carries a skinned mesh does not count; its
# points are where the joints put them.
# Seen with trimesh 5.2.0 (Python 3.11): a triangle whose joint stands at the origin and whose own node is moved by
# 100 units comes out at x = 100 to 101, without a warning. Whoever compares bounds with it takes the right reader
# for the wrong one.
set -euo pipefail
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/env"
"$here/env/bin/pip" --quiet install trimesh==5.2.0 numpy==2.4.6

cat > "$here/try.py" <<'PY'
import base64, json, struct, sys, warnings
import trimesh

points = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
joints = bytes(12)
weights = struct.pack("<12f", *([1, 0, 0, 0] * 3))
identity = struct.pack("<16f", *(1.0 if i % 5 == 0 else 0.0 for i in range(16)))
data = points + joints + weights + identity
view = lambda at, size: {"buffer": 0, "byteOffset": at, "byteLength": size}
number = lambda view, kind, count, form: {"bufferView": view, "componentType": kind, "count": count, "type": form}
model = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0, "skin": 0, "translation": [100, 0, 0]}, {"name": "joint"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}]}],
    "skins": [{"joints": [1], "inverseBindMatrices": 3}],
    "accessors": [
        {**number(0, 5126, 3, "VEC3"), "min": [0, 0, 0], "max": [1, 1, 0]},
        number(1, 5121, 3, "VEC4"), number(2, 5126, 3, "VEC4"), number(3, 5126, 1, "MAT4"),
    ],
    "bufferViews": [view(0, 36), view(36, 12), view(48, 48), view(96, 64)],
    "buffers": [{"byteLength": len(data),
                 "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
}
path = sys.argv[1] + "/skin.gltf"
with open(path, "w") as file:
    json.dump(model, file)
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    bounds = trimesh.load_scene(path).bounds.tolist()
about_skins = [w for w in said if "skin" in str(w.message).lower()]
print("trimesh", trimesh.__version__, "bounds", bounds, "warnings on skins", len(about_skins))
assert bounds == [[100.0, 0.0, 0.0], [101.0, 1.0, 0.0]] and not about_skins, "the behavior has changed"
PY
"$here/env/bin/python" "$here/try.py" "$here"
