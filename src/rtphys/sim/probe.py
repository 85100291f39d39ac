"""Can this machine draw? Run as a child process: `python -m rtphys.sim.probe [shader]`.

A broken driver can hang or kill its process, so nobody calls this in-process. The last line of
standard output is a JSON object with a `cause` from `rtphys.doctor.CAUSES`; exit code 0 if a
frame was drawn, else 1.
"""

import json
import os
import sys
import time
import warnings
from pathlib import Path

warnings.filterwarnings("ignore", message="Failed to find system libvulkan")

_GPU_FILES = ("/dev/dri/renderD128", "/dev/dri/renderD129", "/dev/nvidiactl")


def probe(shader: str = "slim") -> dict[str, object]:
    """Find out how far drawing gets; `{"cause": "ok", ...}` when a frame came out."""
    from rtphys.sim import vulkan

    loaded = vulkan.load_library()
    if loaded is None:
        return {"cause": "no_loader", "detail": "libvulkan.so.1 cannot be loaded"}
    library, path = loaded
    facts: dict[str, object] = {"loader": path}
    devices = vulkan.devices(library)
    facts["devices"] = [vars(device) for device in devices]
    if not devices:
        closed = [f for f in _GPU_FILES if Path(f).exists() and not os.access(f, os.R_OK | os.W_OK)]
        if closed:
            return facts | {"cause": "no_permission", "detail": f"cannot open {', '.join(closed)}"}
        return facts | {"cause": "no_driver", "detail": "the Vulkan loader finds no device"}
    if not any(device.partially_bound for device in devices):
        names = ", ".join(f"{device.name} (Vulkan {device.api})" for device in devices)
        return facts | {
            "cause": "old_driver",
            "detail": f"no descriptorBindingPartiallyBound on {names}",
        }
    return facts | _draw(shader)


def _draw(shader: str) -> dict[str, object]:
    try:
        from rtphys.sim import renderer
    except ImportError as error:
        return {"cause": "no_simulator", "detail": f"sapien cannot be imported: {error}"}
    import sapien

    start = time.perf_counter()
    try:
        renderer.configure(shader)
        scene = sapien.Scene()
        renderer.add_lights(scene)
        builder = scene.create_actor_builder()
        builder.add_box_visual(half_size=(0.1, 0.1, 0.1))
        builder.initial_pose = sapien.Pose([1, 0, 0])
        builder.build_static(name="box")
        camera = scene.add_camera("eye", 64, 48, 0.6, 0.1, 100.0)
        scene.update_render()
        picture = renderer.capture(camera)
    except (RuntimeError, IndexError) as error:
        return {"cause": "no_frame", "detail": str(error)}
    if picture.min() == picture.max():
        return {"cause": "no_frame", "detail": "the test frame has one colour only"}
    return {
        "cause": "ok",
        "detail": "drew a frame",
        "sapien": sapien.__version__,
        "first_frame_s": round(time.perf_counter() - start, 2),
    }


if __name__ == "__main__":
    result = probe(*sys.argv[1:2])
    print(json.dumps(result))
    sys.stdout.flush()
    # Skip SAPIEN's teardown: after a failed frame it may abort and hide the answer.
    os._exit(0 if result["cause"] == "ok" else 1)
