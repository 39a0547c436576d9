"""Renders scenes with Mitsuba 3: pairs of a scene file and the picture to be made of it."""

import sys

import mitsuba

mitsuba.set_variant("scalar_rgb")
seed, pairs = int(sys.argv[1]), sys.argv[2:]
for scene, picture in zip(pairs[::2], pairs[1::2]):
    image = mitsuba.render(mitsuba.load_file(scene), seed=seed)
    mitsuba.util.write_bitmap(picture, image, write_async=False)
    print(picture, flush=True)
