#!/usr/bin/env bash
# OpenImageIO reads 16-bit DDS as 8 bits, while it reports 16.
#
# Expected: a DDS of the format R16_UNORM (a height map) or R10G10B10A2_UNORM
#   (a normal map) is read with its own precision, as 16-bit PNG and TIFF are.
# Seen: the reader cuts each channel to its top 8 bits. 65536 heights become
#   256, 1024 steps of a normal become 256; asked for uint16 or float it widens
#   those 8 bits again, so the type looks right. "oiio:BitsPerSample" says 16
#   for the height map, only spec.format (uint8) gives it away. Heights that
#   differ by less than 256 come out equal. No warning.
# Versions: OpenImageIO 3.2.2.0.
# Why it matters: slopes of a height map are differences of neighbours. A soft
#   ramp of 16-bit heights has slope 0 nearly everywhere and a jump of 257 now
#   and then: bump mapping shows terraces, and one looks for the fault in
#   one's own fixed point.
# Source: DXGI_FORMAT_R16_UNORM and DXGI_FORMAT_R10G10B10A2_UNORM in Microsoft's
#   DDS and DXGI reference. OpenImageIO's manual, DDS, lists oiio:BitsPerSample
#   as the bits per sample and does not name the cut.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install OpenImageIO==3.2.2.0 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import struct, sys
import numpy as np, OpenImageIO as oiio

def write(name, w, h, dxgi, pixel_bytes, data):
    pf = struct.pack("<II4s5I", 32, 4, b"DX10", 0, 0, 0, 0, 0)
    head = struct.pack("<4s7I44x", b"DDS ", 124, 0x100F, h, w, w * pixel_bytes, 0, 0)
    head += pf + struct.pack("<5I", 0x1000, 0, 0, 0, 0) + struct.pack("<5I", dxgi, 3, 0, 1, 0)
    open(name, "wb").write(head + data)

def read(name, kind):
    inp = oiio.ImageInput.open(name)
    if inp is None:
        sys.exit("behaviour changed: " + oiio.geterror())
    spec = inp.spec()
    return np.asarray(inp.read_image(kind)), str(spec.format), spec.getattribute("oiio:BitsPerSample")

heights = np.arange(65536, dtype="<u2")
write("height.dds", 256, 256, 56, 2, heights.tobytes())
got, kind, bits = read("height.dds", "uint16")
got = got.ravel()
slopes = np.diff(got.astype(int))
print(f"R16_UNORM: format {kind}, BitsPerSample {bits}; {len(set(heights.tolist()))} heights in the file,"
      f" {len(set(got.tolist()))} read")
print(f"  file {heights[250:260].tolist()}")
print(f"  read {got[250:260].tolist()}; slopes that occur: {sorted(set(slopes.tolist()))} (right: [1])")
x = np.arange(1024, dtype="<u4")
write("normal.dds", 32, 32, 24, 4, (x | (1023 - x) << 10 | 3 << 30).astype("<u4").tobytes())
n, _, _ = read("normal.dds", "float")
red = n.reshape(-1, n.shape[-1])[:, 0]
print(f"R10G10B10A2_UNORM: 1024 steps in the file, {len(set(red.tolist()))} read;"
      f" 513 / 1023 = {513 / 1023:.6f} is read as {red[513]:.6f}")
ok = (len(set(got.tolist())) == 256 and sorted(set(slopes.tolist())) == [0, 257] and bits == 16
      and kind == "uint8" and len(set(red.tolist())) == 256)
if not ok:
    sys.exit("behaviour changed: OpenImageIO keeps more (or other) bits of these formats now")
PY
echo "as described"
