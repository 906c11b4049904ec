// Files by three.js, glTF Transform and ktx-parse. Run where the packages are installed: node scenes.mjs FOLDER.
import fs from 'node:fs';
import path from 'node:path';
import * as THREE from 'three';
import { OBJExporter } from 'three/addons/exporters/OBJExporter.js';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { EXRExporter } from 'three/addons/exporters/EXRExporter.js';
import { KTX2Exporter } from 'three/addons/exporters/KTX2Exporter.js';
import { Document, NodeIO } from '@gltf-transform/core';
import { KHRMeshQuantization } from '@gltf-transform/extensions';
import { quantize, tangents, unweld } from '@gltf-transform/functions';
import { generateTangents } from 'mikktspace';
import * as KTX from 'ktx-parse';

const folder = process.argv[2];
const write = (name, data) => fs.writeFileSync(path.join(folder, name), data);

// The exporter of glTF wants a browser's reader of blobs.
globalThis.FileReader = class {
  readAsArrayBuffer(blob) { blob.arrayBuffer().then((b) => { this.result = b; this.onloadend(); }); }
};

// A box of 1 x 1 x 1, turned by a group and shifted by a mesh; the shape is said again in meshes.py.
const box = new THREE.Mesh(new THREE.BoxGeometry(1, 1, 1), new THREE.MeshStandardMaterial({ color: 0xffffff }));
box.position.set(0.25, 0, 0);
const group = new THREE.Group();
group.rotation.set(Math.PI / 6, Math.PI / 5, 0);
group.scale.set(1.5, 1, 1);
group.add(box);
group.updateMatrixWorld(true);
write('three_box.obj', new OBJExporter().parse(group));
write('three_box.glb', Buffer.from(await new GLTFExporter().parseAsync(group, { binary: true })));

// The test surroundings by longitude and latitude. Rows of a texture go upwards.
const [width, height] = [256, 128];
const light = new Float32Array(width * height * 4);
for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
  const lon = ((x + 0.5) / width - 0.5) * 2 * Math.PI, lat = ((y + 0.5) / height - 0.5) * Math.PI;
  const d = [Math.sin(lon) * Math.cos(lat), Math.sin(lat), -Math.cos(lon) * Math.cos(lat), 1];
  d.forEach((v, c) => { light[(y * width + x) * 4 + c] = (v + 1) / 2; });
}
const texture = new THREE.DataTexture(light, width, height, THREE.RGBAFormat, THREE.FloatType);
write('three_half.exr', await new EXRExporter().parse(texture, { type: THREE.HalfFloatType }));
write('three_float.exr', await new EXRExporter().parse(texture, { type: THREE.FloatType }));
texture.colorSpace = THREE.LinearSRGBColorSpace;
write('three_flat.ktx2', Buffer.from(await new KTX2Exporter().parse(texture)));

// A cube of the test surroundings in Vulkan's order and orientation: half floats, six faces.
const edge = 64, faces = [];
const toward = [
  (s, t) => [1, -t, -s], (s, t) => [-1, -t, s], (s, t) => [s, 1, t],
  (s, t) => [s, -1, -t], (s, t) => [s, -t, 1], (s, t) => [-s, -t, -1],
];
const bytes = new Uint16Array(6 * edge * edge * 4);
toward.forEach((f, face) => {
  for (let y = 0; y < edge; y++) for (let x = 0; x < edge; x++) {
    const at = ((face * edge + y) * edge + x) * 4;
    const d = new THREE.Vector3(...f((x + 0.5) * 2 / edge - 1, (y + 0.5) * 2 / edge - 1)).normalize();
    [d.x, d.y, d.z, 1].forEach((v, c) => { bytes[at + c] = THREE.DataUtils.toHalfFloat((v + 1) / 2); });
  }
});
const cube = KTX.createDefaultContainer();
cube.vkFormat = KTX.VK_FORMAT_R16G16B16A16_SFLOAT;
cube.typeSize = 2;
cube.pixelWidth = cube.pixelHeight = edge;
cube.faceCount = 6;
cube.levels = [{ levelData: new Uint8Array(bytes.buffer), uncompressedByteLength: bytes.byteLength }];
const part = (channelType, i) => ({
  bitOffset: 16 * i, bitLength: 15, channelType: channelType | 0xc0, samplePosition: [0, 0, 0, 0], sampleLower: 0xbf800000, sampleUpper: 0x3f800000,
});
Object.assign(cube.dataFormatDescriptor[0], {
  colorModel: 1, colorPrimaries: 1, transferFunction: 1, bytesPlane: [8, 0, 0, 0, 0, 0, 0, 0],
  samples: [0, 1, 2, 15].map(part),
});
write('ktx_cube.ktx2', KTX.write(cube));

// A square with normalized 16-bit texture coordinates and positions, and tangents by MikkTSpace, under two nodes.
const model = new Document(), buffer = model.createBuffer();
const accessor = (kind, list) => model.createAccessor().setType(kind).setArray(list).setBuffer(buffer);
const primitive = model.createPrimitive()
  .setAttribute('POSITION', accessor('VEC3', new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0])))
  .setAttribute('NORMAL', accessor('VEC3', new Float32Array([0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1])))
  .setAttribute('TEXCOORD_0', accessor('VEC2', new Float32Array([0, 1, 1, 1, 1, 0, 0, 0])))
  .setIndices(accessor('SCALAR', new Uint16Array([0, 1, 2, 0, 2, 3])));
const bump = model.createTexture('bump').setMimeType('image/png').setImage(fs.readFileSync(path.join(folder, 'bump_for_gltf.png')));
const colours = model.createTexture('colours').setMimeType('image/png').setImage(fs.readFileSync(path.join(folder, 'colours_for_gltf.png')));
primitive.setMaterial(model.createMaterial().setNormalTexture(bump).setBaseColorTexture(colours).setRoughnessFactor(0).setMetallicFactor(1));
const inner = model.createNode().setMesh(model.createMesh().addPrimitive(primitive)).setTranslation([0.5, 0, 0]);
const outer = model.createNode().addChild(inner).setRotation([0, 0, Math.SQRT1_2, Math.SQRT1_2]).setScale([0.5, 1, 1]);
model.createScene().addChild(outer);
await model.transform(unweld(), tangents({ generateTangents, overwrite: true }));
write('transform_floats.glb', await new NodeIO().writeBinary(model));
await model.transform(quantize());
write('transform_square.glb', await new NodeIO().registerExtensions([KHRMeshQuantization]).writeBinary(model));
