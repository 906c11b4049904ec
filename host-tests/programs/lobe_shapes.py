"""How well sums of normal laws reflect, if each has a centre or a shape of its own: a study without the project's code.

    python3 lobe_shapes.py HEIGHTS.png...

Needs numpy and Pillow. For each picture of heights the slopes are taken as facets. Expectation maximisation fits k laws to them:

- widths: one centre and one shape, a width for each law (decision 071);
- shapes: one centre, a covariance for each law;
- centres: a centre and a covariance for each law.

Each law reflects three generated skies at slopes of 0.1, 0.25 and 0.5 (root mean square of both components together), from 8 to 40 degrees above the
surface, in three azimuths. A line has the root mean square and the range of log2(reflected by the laws / reflected by the facets).
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

RANDOM = np.random.default_rng(5)
SAMPLES = 100_000
FITTED = 20_000
LEAST_VARIANCE = 4e-4  # of a fitted law, in units of the whole variance


def facets(path):
    """Slopes of a picture whose edges join, mean 0, root mean square 1."""
    heights = np.asarray(Image.open(path).convert("F"))
    slopes = np.stack([np.roll(heights, -1, axis) - np.roll(heights, 1, axis) for axis in (1, 0)], -1).reshape(-1, 2)
    slopes -= slopes.mean(0)
    return slopes / np.sqrt((slopes**2).sum(1).mean())


def log_density(slopes, centre, covariance):
    away = slopes - centre
    distance = np.einsum("ni,ni->n", away @ np.linalg.inv(covariance), away)
    return -0.5 * (distance + np.log(np.linalg.det(covariance)))


def fitted(slopes, count, kind, start):
    """Weights, centres and covariances after 200 rounds, with the likelihood that they reach."""
    random = np.random.default_rng(start)
    whole = np.cov(slopes.T)
    weights = np.full(count, 1 / count)
    centres = slopes[random.choice(len(slopes), count)] if kind == "centres" else np.zeros((count, 2))
    # Slightly different shapes, or laws of one centre would stay alike.
    covariances = np.stack([whole * np.outer(s, s) for s in random.uniform(0.4, 1.4, (count, 2))])
    if kind == "widths":
        covariances = np.stack([whole * width**2 for width in np.linspace(0.3, 1.6, count)])
    for _ in range(200):
        logs = np.stack([np.log(w) + log_density(slopes, c, v) for w, c, v in zip(weights, centres, covariances)], 1)
        most = logs.max(1, keepdims=True)
        shares = np.exp(logs - most)
        likelihood = float((np.log(shares.sum(1)) + most[:, 0]).mean())
        shares /= shares.sum(1, keepdims=True)
        weights = np.maximum(shares.mean(0), 1e-9)
        if kind == "centres":
            centres = shares.T @ slopes / (len(slopes) * weights)[:, None]
        for law in range(count):
            away = slopes - centres[law]
            own = (shares[:, law, None] * away).T @ away / (len(slopes) * weights[law])
            if kind == "widths":
                own = whole * np.trace(np.linalg.solve(whole, own)) / 2
            covariances[law] = own + np.eye(2) * LEAST_VARIANCE * np.trace(whole)
    return likelihood, weights / weights.sum(), centres, covariances


def best(slopes, count, kind):
    some = slopes[RANDOM.choice(len(slopes), FITTED)]
    starts = range(1 if kind == "widths" else 4)
    return max((fitted(some, count, kind, start) for start in starts), key=lambda fit: fit[0])[1:]


def drawn(weights, centres, covariances):
    laws = RANDOM.choice(len(weights), SAMPLES, p=weights)
    roots = np.linalg.cholesky(covariances)
    return centres[laws] + np.einsum("nij,nj->ni", roots[laws], RANDOM.standard_normal((SAMPLES, 2)))


def unit(vector):
    return np.array(vector) / np.linalg.norm(vector)


# Direction of a sun, its radius in degrees, its light, and the light of the haze around it.
SKIES = [(unit([0.4, 0.3, -1]), 3, 250, 5), (unit([-1, 0.7, -0.4]), 2, 80, 8), (unit([0.1, 1, 0.2]), 4, 30, 2)]


def light(directions, sky):
    sun, degrees, disc, haze = sky
    up, near = directions[:, 1], directions @ sun
    above = 0.25 + 0.75 * np.maximum(1 - up, 0) ** 3 + haze * np.exp(50 * (near - 1)) + disc * (near > np.cos(np.radians(degrees)))
    ground = 0.06 + 0.04 * np.sin(7 * directions[:, 2])
    return np.where(up > 0, above, ground)


def reflected(slopes, view, sky):
    """Mean light that facets of these slopes reflect to the viewer."""
    normals = np.stack([-slopes[:, 0], np.ones(len(slopes)), -slopes[:, 1]], 1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return light(2 * normals * (normals @ view)[:, None] - view, sky).mean()


VIEWS = [
    np.array([np.cos(a) * np.sin(b), np.sin(a), np.cos(a) * np.cos(b)])
    for a in np.radians([8, 14, 20, 30, 40])
    for b in np.radians([0, 90, 180])
]


def main():
    for path in map(Path, sys.argv[1:]):
        slopes = facets(path)
        some = slopes[RANDOM.choice(len(slopes), min(len(slopes), 2 * SAMPLES), replace=False)]
        cases = [(rms, sky, view) for rms in (0.1, 0.25, 0.5) for sky in SKIES for view in VIEWS]
        truth = np.array([reflected(rms * some, view, sky) for rms, sky, view in cases])
        for kind, count in [("widths", 1)] + [(kind, n) for kind in ("widths", "shapes", "centres") for n in (2, 3, 4)]:
            laws = best(slopes, count, kind)
            samples = drawn(*laws)
            error = np.log2([reflected(rms * samples, view, sky) for rms, sky, view in cases] / truth)
            print(f"{path.stem}, {count} {kind}: {np.sqrt((error**2).mean()):.3f} ({error.min():.2f} to {error.max():.2f})", flush=True)


if __name__ == "__main__":
    main()
