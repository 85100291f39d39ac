"""What Vulkan devices this machine offers, asked of the loader itself, without SAPIEN.

SAPIEN reports every shortcoming as "failed to find a rendering device"; this says which one.
Numbers and layouts are those of the Vulkan 1.2 specification.
"""

import ctypes
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

_API_1_2 = (1 << 22) | (2 << 12)
_INSTANCE_CREATE_INFO, _APPLICATION_INFO = 1, 0
_FEATURES_2, _DESCRIPTOR_INDEXING_FEATURES = 1000059000, 1000161001
_PARTIALLY_BOUND = 17  # position among the twenty flags of the descriptor indexing features
_KINDS = {0: "other", 1: "integrated GPU", 2: "discrete GPU", 3: "virtual GPU", 4: "CPU"}


@dataclass(frozen=True)
class Device:
    """One physical device as the loader lists it."""

    name: str
    kind: str
    api: str  # Vulkan version the driver speaks
    partially_bound: bool  # descriptorBindingPartiallyBound, which SAPIEN needs


class _Application(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_uint32),
        ("next", ctypes.c_void_p),
        ("name", ctypes.c_char_p),
        ("version", ctypes.c_uint32),
        ("engine", ctypes.c_char_p),
        ("engine_version", ctypes.c_uint32),
        ("api_version", ctypes.c_uint32),
    ]


class _InstanceInfo(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_uint32),
        ("next", ctypes.c_void_p),
        ("flags", ctypes.c_uint32),
        ("application", ctypes.POINTER(_Application)),
        ("layer_count", ctypes.c_uint32),
        ("layers", ctypes.c_void_p),
        ("extension_count", ctypes.c_uint32),
        ("extensions", ctypes.c_void_p),
    ]


class _Indexing(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_uint32),
        ("next", ctypes.c_void_p),
        ("flags", ctypes.c_uint32 * 20),
    ]


class _Features(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_uint32),
        ("next", ctypes.c_void_p),
        ("flags", ctypes.c_uint32 * 55),
    ]


class _Properties(ctypes.Structure):
    _fields_ = [
        ("api", ctypes.c_uint32),
        ("driver", ctypes.c_uint32),
        ("vendor", ctypes.c_uint32),
        ("device", ctypes.c_uint32),
        ("kind", ctypes.c_uint32),
        ("name", ctypes.c_char * 256),
        ("rest", ctypes.c_uint8 * 1024),  # limits and sparse properties, not read
    ]


def load_library() -> tuple[ctypes.CDLL, str] | None:
    """The Vulkan loader and its path: the system's, else the one inside SAPIEN, else None."""
    spec = find_spec("sapien")
    bundled = []
    if spec and spec.origin:
        folder = Path(spec.origin).parent / "vulkan_library"
        bundled = [str(p) for p in sorted(folder.glob("libvulkan.so*"))]
    for path in ["libvulkan.so.1", *bundled]:
        try:
            return ctypes.CDLL(path), path
        except OSError:
            continue
    return None


def devices(library: ctypes.CDLL) -> list[Device]:
    """All physical devices; empty where no driver is installed or none accepts the machine.

    May crash the process if a driver is broken: call it in a child.
    """
    application = _Application(type=_APPLICATION_INFO, api_version=_API_1_2)
    info = _InstanceInfo(type=_INSTANCE_CREATE_INFO, application=ctypes.pointer(application))
    instance = ctypes.c_void_p()
    if library.vkCreateInstance(ctypes.byref(info), None, ctypes.byref(instance)) != 0:
        return []
    count = ctypes.c_uint32()
    library.vkEnumeratePhysicalDevices(instance, ctypes.byref(count), None)
    handles = (ctypes.c_void_p * count.value)()
    library.vkEnumeratePhysicalDevices(instance, ctypes.byref(count), handles)
    devices = [_describe(library, ctypes.c_void_p(handle)) for handle in handles]
    library.vkDestroyInstance(instance, None)
    return devices


def _describe(library: ctypes.CDLL, handle: ctypes.c_void_p) -> Device:
    properties = _Properties()
    library.vkGetPhysicalDeviceProperties(handle, ctypes.byref(properties))
    indexing = _Indexing(type=_DESCRIPTOR_INDEXING_FEATURES)
    features = _Features(type=_FEATURES_2, next=ctypes.addressof(indexing))
    library.vkGetPhysicalDeviceFeatures2(handle, ctypes.byref(features))
    api = properties.api
    return Device(
        name=properties.name.decode(errors="replace"),
        kind=_KINDS.get(properties.kind, "other"),
        api=f"{api >> 22 & 0x7F}.{api >> 12 & 0x3FF}.{api & 0xFFF}",
        partially_bound=bool(indexing.flags[_PARTIALLY_BOUND]),
    )
