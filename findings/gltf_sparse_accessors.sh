#!/usr/bin/env bash
# glTF sparse accessors: three replaces vertices of an interleaved mesh by its normals, three other libraries ignore the replaced values.
#
# Expected: a sparse accessor is core glTF 2.0: first the elements of its buffer view, or zeros if there is none,
#   then a list of elements that are replaced. Which layout the buffer view has, makes no difference.
# Seen, four vertices of a flat plate, one lifted to 5 by the sparse part: 1. Positions and normals interleaved, a usual
#   layout: three gives 8 vertices, every second one a normal. The array is taken without its stride. The same without
#   interleaving, if there is padding: 16-bit positions (KHR_mesh_quantization) must have a stride of 8, and three
#   makes 5.33 vertices of the four. With tight floats three is right. Babylon.js and glTF-Transform are right in all cases.
#   2. trimesh, PyMeshLab and panda3d-gltf read the flat plate: they ignore the sparse part. Without a buffer view
#   trimesh reads zeros for all vertices. The min and max of the accessor, which hold the 5, are not compared.
#   No message in any of these cases; the validator has no error and no warning for the four files.
# Versions: three 0.187.0, @babylonjs/core and loaders 9.28.0, @gltf-transform/core and extensions 4.5.1,
#   gltf-validator 2.0.0-dev.3.10 (npm); trimesh 5.2.0, pymeshlab 2025.7.post1, panda3d 1.10.16, panda3d-gltf 1.3.0, numpy 2.4.6.
# Why it matters: sparse accessors are the glTF way to store a few displaced heights over a common grid. The one loader makes
#   spikes of them, the others a plate without relief, which passes for a model whose bumps are all in the normal map.
# Source: glTF 2.0, Sparse Accessors (the rule above) and Accessors Bounds (min and max are those after the replacement);
#   Data Alignment: each element of a vertex attribute starts at a multiple of 4 bytes.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
cd "$T"
python3 -m venv v
nice v/bin/pip -q --disable-pip-version-check install trimesh==5.2.0 pymeshlab==2025.7.post1 panda3d==1.10.16 panda3d-gltf==1.3.0 numpy==2.4.6
echo '{"private": true, "type": "module"}' > package.json
nice npm install --silent --no-audit --no-fund --no-update-notifier three@0.187.0 @babylonjs/core@9.28.0 @babylonjs/loaders@9.28.0 \
  @gltf-transform/core@4.5.1 @gltf-transform/extensions@4.5.1 gltf-validator@2.0.0-dev.3.10 > npm.log 2>&1 || {
  cat npm.log >&2
  exit 1
}

cat > write.py <<'PY'
import base64, json
import numpy as np

flat = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
right = flat.copy()
right[2, 2] = 5
faces = np.array([0, 1, 2, 0, 2, 3], "<u2")

def save(name, base, changed, kind, stride=None, normals_at=None):
    """base: bytes of a buffer view or None; changed: numbers of the replaced vertices; kind: of the positions."""
    parts = [(faces.tobytes(), {"target": 34963}), (np.array(changed, "<u2").tobytes(), {}), (right[changed].astype(kind).tobytes(), {})]
    positions = {"componentType": {"<f4": 5126, "<i2": 5122}[kind], "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [1, 1, 5],
                 "sparse": {"count": len(changed), "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 2}}}
    accessors = [{"bufferView": 0, "componentType": 5123, "type": "SCALAR", "count": 6}, positions]
    attributes = {"POSITION": 1}
    if base is not None:
        parts.append((base, {"target": 34962, **({"byteStride": stride} if stride else {})}))
        positions["bufferView"] = 3
    if normals_at is not None:
        accessors.append({"bufferView": 3, "byteOffset": normals_at, "componentType": 5126, "type": "VEC3", "count": 4})
        attributes["NORMAL"] = 2
    data, views = b"", []
    for part, more in parts:
        data += bytes(-len(data) % 4)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part), **more})
        data += part
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    model = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "accessors": accessors,
             "bufferViews": views, "buffers": [{"byteLength": len(data), "uri": uri}], "materials": [{}],
             "meshes": [{"primitives": [{"attributes": attributes, "indices": 0, "material": 0}]}]}
    if kind == "<i2":
        model["extensionsUsed"] = model["extensionsRequired"] = ["KHR_mesh_quantization"]
    with open(name + ".gltf", "w") as f:
        json.dump(model, f)

normals = np.tile([0, 0, 1], (4, 1))
save("tight", flat.astype("<f4").tobytes(), [2], "<f4")
save("interleaved", np.hstack([flat, normals]).astype("<f4").tobytes(), [2], "<f4", 24, 12)
save("padded", np.hstack([flat, np.zeros((4, 1))]).astype("<i2").tobytes(), [2], "<i2", 8)
save("no_base", None, [1, 2, 3], "<f4")
PY
nice v/bin/python write.py

cat > look.js <<'JS'
import fs from 'node:fs'
import validator from 'gltf-validator'
import { NodeIO } from '@gltf-transform/core'
import { KHRONOS_EXTENSIONS } from '@gltf-transform/extensions'
globalThis.self = globalThis
globalThis.ProgressEvent = class extends Event {}
const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js')
const { NullEngine } = await import('@babylonjs/core/Engines/nullEngine.js')
const { Logger } = await import('@babylonjs/core/Misc/logger.js')
const { Scene } = await import('@babylonjs/core/scene.js')
const { AppendSceneAsync } = await import('@babylonjs/core/Loading/sceneLoader.js')
await import('@babylonjs/loaders/glTF/2.0/index.js')
Logger.LogLevels = Logger.ErrorLogLevel
const messages = []
console.warn = console.error = (...text) => messages.push(text.join(' '))
const fail = what => { console.log('behaviour changed: ' + what); process.exit(1) }

async function three (text) {
  const points = []
  const model = await new GLTFLoader().parseAsync(text, '')
  model.scene.traverse(part => {
    if (!part.isMesh) return
    const p = part.geometry.attributes.position
    for (let i = 0; i + 1 <= p.count; i++) points.push(p.getX(i), p.getY(i), p.getZ(i))
  })
  return points
}
async function babylon (text) {
  const scene = new Scene(new NullEngine())
  await AppendSceneAsync('data:' + text, scene, { pluginExtension: '.gltf' })
  return [...scene.meshes.find(mesh => mesh.getTotalVertices()).getVerticesData('position')]
}
async function transform (text) {
  const model = await new NodeIO().registerExtensions(KHRONOS_EXTENSIONS).readJSON({ json: JSON.parse(text), resources: {} })
  return [...model.getRoot().listMeshes()[0].listPrimitives()[0].getAttribute('POSITION').getArray()]
}
const right = '0 0 0  1 0 0  1 1 5  0 1 0'
const seen = {
  tight: right,
  interleaved: '0 0 0  0 0 1  1 1 5  0 0 1  1 1 0  0 0 1  0 1 0  0 0 1',
  padded: '0 0 0  0 1 0  1 1 5  1 0 0  0 1 0', // the count is 5.33
  no_base: right
}
for (const name of Object.keys(seen)) {
  const text = fs.readFileSync(name + '.gltf', 'utf8')
  const { issues } = await validator.validateString(text)
  if (issues.numErrors + issues.numWarnings) fail('the validator does not accept ' + name)
  for (const [title, read] of Object.entries({ three, 'Babylon.js': babylon, 'glTF-Transform': transform })) {
    const points = await read(text)
    const rows = []
    for (let i = 0; i < points.length; i += 3) rows.push(points.slice(i, i + 3).join(' '))
    console.log(`${name.padEnd(12)} ${title.padEnd(15)} ${rows.join('  ')}`)
    if (rows.join('  ') !== (title === 'three' ? seen[name] : right)) fail(`${title} with ${name}`)
  }
}
if (messages.length) fail('a message: ' + messages[0])
JS
nice node look.js

cat > look.py <<'PY'
import logging, sys
import gltf, numpy as np, pymeshlab, trimesh
from panda3d.core import GeomVertexReader, NodePath

records = []
logging.basicConfig(handlers=[type("Keep", (logging.Handler,), {"emit": lambda self, record: records.append(record.getMessage())})()])

def by_trimesh(name):
    return trimesh.load_mesh(name, process=False).vertices

def by_pymeshlab(name):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(name)
    return meshes.current_mesh().vertex_matrix()

def by_panda(name):
    part = NodePath(gltf.load_model(name)).find("**/+GeomNode").node()
    reader, points = GeomVertexReader(part.get_geom(0).get_vertex_data(), "vertex"), []
    while not reader.is_at_end():
        x, y, z = reader.get_data3()
        points.append([x, z, -y])  # panda3d-gltf turns y up into z up, and repeats vertices to make normals
    return points

flat, zero = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 0, 0]] * 4
readers = {"trimesh": by_trimesh, "PyMeshLab": by_pymeshlab, "panda3d-gltf": by_panda}
for name in ("tight", "interleaved"):
    for title, read in readers.items():
        points = np.asarray(read(name + ".gltf"))
        print(f"{name:12} {title:15} " + "  ".join(" ".join(f"{v + 0.0:g}" for v in row) for row in points))
        if not np.array_equal(np.unique(points, axis=0), np.unique(flat, axis=0)):
            sys.exit(f"behaviour changed: {title} with {name}")
points = by_trimesh("no_base.gltf")
print("no_base      trimesh         " + "  ".join(" ".join(f"{v:g}" for v in row) for row in points))
if not np.array_equal(points, zero):
    sys.exit("behaviour changed: trimesh without a buffer view")
if records:
    sys.exit("behaviour changed: a message: " + records[0])
PY
nice v/bin/python look.py
echo "as described"
