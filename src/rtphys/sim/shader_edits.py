"""How the slim shader pack differs from SAPIEN's default one, edit by edit.

An edit is (regular expression, replacement) and must match exactly once, so a SAPIEN whose shaders
changed is noticed. Each entry says what it saves; figures are CPU-milliseconds of a 320x240 frame
on one core (lavapipe, 15 000 triangles in 48 objects: default 27, slim 10).
"""

import re

from rtphys.sim.lighting import LIGHTING

Edit = tuple[str, str]

# Transparency, lines and points: one more full-screen pass each. The composite pass only applies
# gamma, which the deferred pass can do itself.
UNUSED_FILES = ("gbuffer1.*", "line.*", "point.*", "composite.vert", "composite0.frag")


def _line(mark: str) -> Edit:
    """Remove the one line that holds `mark`."""
    return rf"[^\n]*{re.escape(mark)}[^\n]*(\n|$)", ""


def _rest(start: str, replacement: str) -> Edit:
    """Replace everything from `start` to the end of the file."""
    return rf"{re.escape(start)}.*\Z", replacement


# Image-based lighting: 5 CPU-seconds in the first frame, and black where no environment map is set.
_NO_ENVIRONMENT = (_line("samplerEnvironment;"), _line("samplerBRDFLUT;"))

# SAPIEN averages 5x5 bilinear shadow lookups by 25 gathers; 3x3 by 4 gathers with the weights
# worked out once is 4 ms cheaper, and its penumbra (9 mm) is still smooth.
_SHADOW = (
    (r"const int PCF_SampleCount = 25;.*?};\n", ""),
    _rest(
        "{\n\tfloat shadow",
        """{
  vec2 g = fract(projCoord.xy * resolution + 0.5f);
  float lit = 0.0f;
  for (int j = 0; j < 2; j++) {
    vec2 wy = j == 0 ? vec2(1 - g.y, 1) : vec2(1, g.y);
    for (int i = 0; i < 2; i++) {
      vec2 wx = i == 0 ? vec2(1 - g.x, 1) : vec2(1, g.x);
      vec2 at = projCoord.xy + vec2(2 * i - 1, 2 * j - 1) * searchUV;
      vec4 t = step(projCoord.z, textureGather(shadowTex, at));
      lit += wy.x * (wx.x * t.w + wx.y * t.z) + wy.y * (wx.x * t.x + wx.y * t.y);
    }
  }
  return lit / 9;
}
""",
    ),
)

# Matrix times vector three times, not matrix times matrix for every vertex.
_SHADOW_VERTEX = (
    _rest(
        "void main() {",
        """void main() {
  vec4 world = objectTransformBuffer.modelMatrix * vec4(position, 1);
  gl_Position = lightBuffer.projectionMatrix * (lightBuffer.viewMatrix * world);
}
""",
    ),
)

# The same, no 4x4 inverse a vertex (cofactors turn normals just as well), no tangents (normal maps
# are not drawn) and no position to interpolate: depth gives it. Normals are in the world's axes.
_VERTEX = (
    _rest(
        "layout(location = 0) out vec4 outPositionRaw;",
        """layout(location = 0) out vec2 outUV;
layout(location = 1) out vec3 outNormal;

void main() {
  mat4 model = objectTransformBuffer.modelMatrix;
  mat3 m = mat3(model);
  mat3 cofactor = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
  vec4 world = model * vec4(position, 1);
  outNormal = cofactor * normal;
  outUV = uv;
  gl_Position = cameraBuffer.projectionMatrix * (cameraBuffer.viewMatrix * world);
}
""",
    ),
)

# Seven render targets become two, 1 ms each, of 12 bytes a pixel: depth gives the position; the
# normal is folded onto an octahedron's two coordinates; specular and roughness fill their target,
# and metallic takes the alpha that opaque parts do not need. What a pixel is written and read with
# misses the cache: 20 bytes were half a millisecond dearer.
_FRAGMENT = (
    _line("in flat uvec4 inSegmentation;"),
    _line("in vec3 objectCoord;"),
    _line("in vec4 inPosition;"),
    (r"in mat3 inTbn;", "in vec3 inNormal;"),
    _line("out vec4 outPositionRaw;"),
    _line("out vec4 outSpecular;"),
    _line("out uvec4 outSegmentation;"),
    _line("out vec4 outCustom;"),
    _line("out vec4 outEmission;"),
    (r"out vec4 outNormal;", "out vec4 outSurface;"),
    (r"void main\(\) {", "void main() {\n  vec3 outSpecular;"),
    _line("outCustom = "),
    _line("outSegmentation = "),
    _line("outPositionRaw = "),
    (r"  outEmission = materialBuffer\.emission;\n", ""),
    (r"  if \(\(materialBuffer\.textureMask & 16\) != 0\) {\n.*?\n  }\n", ""),
    _rest(
        "  if (objectDataBuffer.shadeFlat",
        """  vec3 n = inNormal * (1 / (abs(inNormal.x) + abs(inNormal.y) + abs(inNormal.z)));
  vec2 below = (1 - abs(n.yx)) * mix(vec2(1), vec2(-1), lessThan(n.xy, vec2(0)));
  outSurface = vec4(n.z < 0 ? below : n.xy, outSpecular.rg);
  outAlbedo.a = outSpecular.b;
}
""",
    ),
)

_DEFERRED = (
    _line("samplerPositionRaw;"),
    _line("samplerSpecular;"),
    _line("samplerEmission;"),
    _line("samplerCustom;"),
    (r"uniform sampler2D samplerNormal;", "uniform sampler2D samplerSurface;"),
    (r"out vec4 outLighting;", "out vec4 outColor;"),
    _rest("vec4 world2camera(vec4 pos) {", LIGHTING),
)

EDITS: dict[str, tuple[Edit, ...]] = {
    "common/shadow.glsl": _SHADOW,
    "slim/scene_set.glsl": _NO_ENVIRONMENT,
    "slim/shadow.vert": _SHADOW_VERTEX,
    "slim/gbuffer.vert": _VERTEX,
    "slim/gbuffer.frag": _FRAGMENT,
    "slim/deferred.frag": _DEFERRED,
}

# The slim pack once more for cameras that are asked for depth and ids. Depth is there already; ids
# of shape and entity cost one more target, a tenth of a picture, and leave its colours as they are.
SENSING: dict[str, tuple[Edit, ...]] = {
    "sensing/gbuffer.frag": (
        (
            r"out vec4 outSurface;",
            "out vec4 outSurface;\nlayout(location = 2) out uvec4 outSegmentation;",
        ),
        (
            r"  outAlbedo\.a = outSpecular\.b;",
            "  outAlbedo.a = outSpecular.b;\n  outSegmentation = objectDataBuffer.segmentation;",
        ),
    ),
}
