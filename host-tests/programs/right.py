"""Right values by numpy alone: rays of a camera, hits of triangles, a colour for each direction, sRGB codes."""
import numpy as np

BACKGROUND = np.array([0, 0, 0])


def unit(vectors):
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def codes(linear):
    """sRGB codes, 0 to 255, not rounded."""
    linear = np.clip(np.asarray(linear, float), 0, 1)
    return 255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def linear(codes_):
    """Linear light of sRGB codes."""
    c = np.asarray(codes_, float) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def light(directions):
    """Linear colour of the test surroundings: (direction + 1) / 2, so each direction has a colour of its own."""
    return (unit(directions) + 1) / 2


def panorama(width, height):
    """Test surroundings by longitude and latitude: the middle looks along -z, +x is to its right, +y is above."""
    longitude = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    latitude = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    lon, lat = np.meshgrid(longitude, latitude)
    return light(np.stack([np.sin(lon) * np.cos(lat), np.sin(lat), -np.cos(lon) * np.cos(lat)], -1)).astype("f4")


class Camera:
    def __init__(self, eye, target, up=(0, 1, 0), fov_y=40.0, size=(64, 64)):
        self.eye, self.target, self.up, self.fov_y, self.size = eye, target, up, fov_y, size

    def rays(self, shift=(0.0, 0.0)):
        """Directions through the middles of the pixels, moved by a part of a pixel: (height, width, 3)."""
        width, height = self.size
        forward = unit(np.subtract(self.target, self.eye))
        right = unit(np.cross(forward, self.up))
        above = np.cross(right, forward)
        half = np.tan(np.radians(self.fov_y) / 2)
        x = ((np.arange(width) + 0.5 + shift[0]) * 2 / width - 1) * half * width / height
        y = (1 - (np.arange(height) + 0.5 + shift[1]) * 2 / height) * half
        return unit(forward + x[None, :, None] * right + y[:, None, None] * above)

    def text(self):
        lists = "".join(f"{key} = {[float(x) for x in value]}\n"
                        for key, value in [("eye", self.eye), ("target", self.target), ("up", self.up)])
        return f"[camera]\n{lists}fov_y = {self.fov_y:.9f}\nwidth = {self.size[0]}\nheight = {self.size[1]}\n"


def from_front(half_height, size=(64, 64), distance=500.0):
    """Camera on the +z axis, nearly without perspective; the frame is 2 half_height high."""
    return Camera((0, 0, distance), (0, 0, 0), fov_y=2 * np.degrees(np.arctan(half_height / distance)), size=size)


def hit_triangles(camera, shift, triangles, normals):
    """The nearest front hit of each ray: mask, and the interpolated normals. Both inputs are (n, 3 corners, 3)."""
    rays = camera.rays(shift).reshape(-1, 3)
    nearest, normal = np.full(len(rays), np.inf), np.zeros((len(rays), 3))
    for corners, corner_normals in zip(np.asarray(triangles, float), np.asarray(normals, float)):
        a, b = corners[1] - corners[0], corners[2] - corners[0]
        p = np.cross(rays, b)
        det = p @ a
        with np.errstate(divide="ignore", invalid="ignore"):
            to_eye = np.subtract(camera.eye, corners[0])
            u = (p @ to_eye) / det
            q = np.cross(to_eye, a)
            v, t = (rays @ q) / det, (b @ q) / det
            hit = (det > 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (t < nearest)
        nearest[hit] = t[hit]
        normal[hit] = (corner_normals[0] + u[hit, None] * (corner_normals[1] - corner_normals[0])
                       + v[hit, None] * (corner_normals[2] - corner_normals[0]))
    mask = np.isfinite(nearest)
    normal[mask] = unit(normal[mask])
    return mask, normal


def hit_ball(camera, shift, centre, radius):
    rays = camera.rays(shift).reshape(-1, 3)
    from_centre = np.subtract(camera.eye, centre)
    along = rays @ from_centre
    root = along ** 2 - from_centre @ from_centre + radius ** 2
    mask = root > 0
    t = -along - np.sqrt(np.where(mask, root, 0))
    normal = np.where(mask[:, None], (from_centre + t[:, None] * rays) / radius, 0)
    return mask, normal


def mirrored(camera, hit, margin=0.02):
    """Codes of a mirror in the test surroundings on black, and the pixels whose value does not hang on an edge."""
    width, height = camera.size
    mask, normal = hit((0.0, 0.0))
    sure = np.ones(len(mask), bool)
    for shift in [(margin, 0), (-margin, 0), (0, margin), (0, -margin)]:
        other, turned = hit(shift)
        sure &= (other == mask) & (~mask | (np.linalg.norm(turned - normal, axis=1) < 0.05 + margin))
    rays = camera.rays().reshape(-1, 3)
    out = rays - 2 * (rays * normal).sum(1, keepdims=True) * normal
    colours = np.where(mask[:, None], codes(light(out)), BACKGROUND)
    return colours.reshape(height, width, 3), sure.reshape(height, width)


def flat(triangles):
    """Normals of flat triangles, one for each corner."""
    triangles = np.asarray(triangles, float)
    across = unit(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    return np.repeat(across[:, None], 3, axis=1)
