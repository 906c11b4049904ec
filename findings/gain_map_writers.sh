#!/usr/bin/env bash
# Gain maps: hdrify multiplies the light by an exposure meant for the SDR picture and lifts dark channels; pyultrahdr mixes two sets of primaries.
#
# Expected: a gain map holds the ratio of the HDR picture to the SDR picture. So an HDR picture that is encoded
#   and decoded without JPEG comes back to within two steps of the map (about 2 %), by any tone mapping and any exposure
#   of the SDR picture. A library that chooses a gain for each pixel writes that gain.
# Seen: 1. hdrify's option exposure, "for SDR tone mapping", multiplies the decoded HDR picture too: with 4, a
#   light of 2 comes back as 8.
#   2. With its default, ACES, a pure green light of 10 comes back as (0.87, 10, 0.69), with Khronos neutral as
#   (0.57, 10, 0.57); with AgX the dark red 0.2 is 0.246. Gains below 1 are stored as 1, as minContentBoost
#   is 1 by default, while the largest gain is measured. So a channel that the tone mapping lifted stays there.
#   Reinhard lifts none and is right. With minContentBoost 1/64 all four are right. The decoder is not at
#   fault: the formula by hand gives the same.
#   3. pyultrahdr converts to BT.2020 and weighs the result with BT.709's luminance. Its curve brightens red
#   2.07 times and blue 1.56 times; the file says 1.79 and 1.77, so their order is lost. Grays are right.
# Versions: hdrify 1.2.1 (npm), pyultrahdr 0.1.0, pillow 13.0.0, numpy 2.4.6.
# Why it matters: such JPEG files replace .hdr panoramas on the web. A coloured lamp gets up to 9 % of
#   its light in the two other channels; a file made with exposure 4 lights a scene four times too bright.
# Source: hdrify's types.d.ts: exposure is "for SDR tone mapping"; the decoder need not know the tone mapper, as
#   the map stores HDR / SDR. gainmap-js, from which it is ported, exposes the SDR picture only. Android's Ultra HDR
#   Image Format, gain map generation and decode: min_content_boost is below 1 where HDR is darker than SDR.
#   pyultrahdr's module text: the map is the luminance ratio. ITU-R BT.2020: luminance weights 0.2627, 0.6780, 0.0593.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install pyultrahdr==0.1.0 pillow==13.0.0 numpy==2.4.6
cd "$T"
nice npm install --silent --no-audit --no-fund hdrify@1.2.1
cat > round.mjs <<'JS'
import { encodeGainMap, decodeGainMap } from 'hdrify';

const lights = [[0, 10, 0], [10, 0, 0], [0.2, 0.02, 0.02], [2, 2, 2]];

function make() {
  const data = new Float32Array(lights.length * 4);
  lights.forEach((p, i) => data.set([...p, 1], 4 * i));
  return { width: lights.length, height: 1, data, linearColorSpace: 'linear-rec709' };
}

function byHand({ sdr, gainMap, metadata: m }) {  // the formula of the format, at full display boost
  return lights.map((_, i) => [0, 1, 2].map((c) => {
    const v = sdr[4 * i + c] / 255;
    const linear = v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    const boost = m.gainMapMin[c] + (m.gainMapMax[c] - m.gainMapMin[c]) * (gainMap[4 * i + c] / 255) ** (1 / m.gamma[c]);
    return Math.max(0, (linear + m.offsetSdr[c]) * 2 ** boost - m.offsetHdr[c]);
  }));
}

function round(options) {
  const encoded = encodeGainMap(make(), options);
  const decoded = decodeGainMap(encoded).data;
  const got = lights.map((_, i) => Array.from(decoded.subarray(4 * i, 4 * i + 3)));
  const hand = byHand(encoded);
  got.forEach((p, i) => p.forEach((v, c) => {
    if (Math.abs(v - hand[i][c]) > 1e-3 * (1 + v)) throw new Error('behaviour changed: the decoder differs from the formula');
  }));
  return got;
}

function right(got, factor = 1) {  // within 4 % or 0.004
  return got.every((p, i) => p.every((v, c) => Math.abs(v - factor * lights[i][c]) <= 0.04 * factor * lights[i][c] + 0.004));
}

const text = (got) => got.map((p) => '(' + p.map((v) => v.toPrecision(3).replace(/^0\.00$/, '0')).join(', ') + ')').join(' ');
function check(ok, what) {
  if (!ok) { console.error('behaviour changed: ' + what); process.exit(1); }
}

console.log('lights                     ' + text(lights));
for (const exposure of [1, 4, 0.25]) {
  const got = round({ toneMapping: 'reinhard', exposure });
  console.log(`reinhard, exposure ${exposure}`.padEnd(27) + text(got));
  check(right(got, exposure), 'exposure');
}
for (const toneMapping of [undefined, 'neutral', 'agx', 'reinhard']) {
  const got = round({ toneMapping });
  const wide = round({ toneMapping, minContentBoost: 1 / 64 });
  console.log((toneMapping ?? 'default (aces)').padEnd(27) + text(got));
  console.log('  minContentBoost 1/64'.padEnd(27) + text(wide));
  check(right(got) === (toneMapping === 'reinhard') && right(wide), 'tone mapping ' + toneMapping);
  if (toneMapping === undefined) check(got[0][0] > 0.8 && got[0][2] > 0.6 && got[1][1] > 0.4, 'the floor of ACES');
  if (toneMapping === 'agx') check(got[2][0] > 0.24, 'dark red by AgX');
}
JS
nice node round.mjs
cat > write.py <<'PY'
import json
import numpy as np, pyultrahdr

WHITE, PEAK = 203.0, 1000.0
colours = {"white": (255, 255, 255), "gray": (128, 128, 128), "red": (255, 0, 0), "green": (0, 255, 0), "blue": (0, 0, 255)}
wanted = {}
for name, colour in colours.items():
    picture = np.tile(np.array(colour, "u1"), (64, 64, 1))
    linear = pyultrahdr.srgb_to_linear(picture.astype("f4") / 255)
    nits = pyultrahdr.inverse_tone_map(linear, WHITE, PEAK)  # the curve, in BT.709
    brightest = int(np.argmax(colour))
    wanted[name] = float(nits[0, 0, brightest] / WHITE / linear[0, 0, brightest])
    wide = np.clip(nits @ pyultrahdr.BT709_TO_BT2020.T, 0, PEAK)  # these steps are those of its command line
    gain, low, high = pyultrahdr.compute_gain_map(linear, wide, WHITE)
    by_the_text = wide[0, 0] @ np.array([0.2627, 0.6780, 0.0593]) / WHITE / (linear[0, 0] @ np.array([0.2126, 0.7152, 0.0722]))
    wanted[name + " luminance"] = float(by_the_text)
    wanted[name + " gain"] = float(2 ** gain[0, 0])
    open(name + ".jpg", "wb").write(pyultrahdr.build_ultra_hdr(picture, gain, low, high, PEAK, WHITE, 100, 100))
json.dump(wanted, open("wanted.json", "w"))
PY
nice v/bin/python write.py
cat > read.mjs <<'JS'
import fs from 'node:fs';
import { readJpegGainMap } from 'hdrify';

const wanted = JSON.parse(fs.readFileSync('wanted.json'));
for (const [name, channel, value] of [['white', 0, 1], ['gray', 0, 0.2158605], ['red', 0, 1], ['green', 1, 1], ['blue', 2, 1]]) {
  const image = readJpegGainMap(new Uint8Array(fs.readFileSync(name + '.jpg')));
  const read = image.data[4 * (32 * 64 + 32) + channel] / value;
  const right = wanted[name], luminance = wanted[name + ' luminance'], gain = wanted[name + ' gain'];
  console.log(`pyultrahdr, ${name}: its curve brightens ${right.toFixed(2)} times, by BT.2020's luminance ${luminance.toFixed(2)}; ` +
    `its map says ${gain.toFixed(2)}, hdrify reads ${read.toFixed(2)}`);
  const off = { white: 1, gray: 1, red: 0.868, green: 1.026, blue: 1.136 }[name];
  if (Math.abs(luminance / right - 1) > 0.005 || Math.abs(gain / right / off - 1) > 0.005 || Math.abs(read / gain - 1) > 0.04) {
    console.error('behaviour changed: ' + name + ' in pyultrahdr');
    process.exit(1);
  }
}
JS
nice node read.mjs
echo "as described"
