"""The lighting pass of the slim shader pack: what SAPIEN's default one computes, put otherwise.

A CPU works out for every pixel even what all pixels share, such as a product of two matrices.
Lighting happens in the world's axes, where lights need no turning, and what the lights of a pixel
share is worked out once: 1.2 of 12 CPU-milliseconds of a 320x240 picture. Powers are roots and
products, half a millisecond. Only ambient, directional and point lights shine, and only
directional ones cast shadows.
"""

LIGHTING = """struct Surface {
  vec3 normal;
  vec3 toCamera;
  float facing;  // normal . toCamera
  float NoV;  // the same, kept off zero
  vec3 diffuse;
  vec3 fresnel;
  float alpha2;
  float k;
};

// Light reflected to the camera of light that comes from the direction L: Lambert and GGX, as in
// common/lights.glsl. The half vector H is known by its products alone: |L + V|^2 = 2 + 2 L.V.
vec3 reflected(Surface s, vec3 L) {
  float lit = dot(s.normal, L);
  float sum2 = 2 + 2 * dot(L, s.toCamera);
  float h = sum2 < 1e-6 ? 0 : inversesqrt(sum2);
  float NoH = clamp((lit + s.facing) * h, 1e-6, 1);
  float VoH = clamp(0.5 * sum2 * h, 1e-6, 1);
  float NoL = clamp(lit, 0, 1);
  float rim = (1 - VoH) * (1 - VoH);
  vec3 F = s.fresnel + (1 - s.fresnel) * (rim * rim * (1 - VoH));  // Schlick's fifth power
  float n = NoH * NoH * (s.alpha2 - 1) + 1;
  const float PI4 = 4 * 3.141592653589793f;
  float nom = PI4 * n * n * (s.NoV * (1 - s.k) + s.k) * (NoL * (1 - s.k) + s.k);
  return NoL * (s.diffuse + F * (s.alpha2 / clamp(nom, 1e-6, PI4)));
}

float shadow(int i, vec3 place) {
  mat4 view = shadowBuffer.directionalLightBuffers[i].viewMatrix;
  mat4 proj = shadowBuffer.directionalLightBuffers[i].projectionMatrix;
  vec3 p = mat3(view) * place + view[3].xyz;
  // Its rays are parallel: the projection only scales and shifts.
  p = p * vec3(proj[0].x, proj[1].y, proj[2].z) + proj[3].xyz;
  p.xy = p.xy * 0.5 + 0.5;
  float resolution = textureSize(samplerDirectionalLightDepths[i], 0).x;
  return ShadowMapPCF(samplerDirectionalLightDepths[i], p, resolution, 1 / resolution, 1);
}

// A direction from its place on the unfolded octahedron; of any length.
vec3 unfolded(vec2 at) {
  float z = 1 - abs(at.x) - abs(at.y);
  float below = max(-z, 0);
  return vec3(at + mix(vec2(-below), vec2(below), lessThan(at, vec2(0))), z);
}

// The 2.2th root of each colour, to a ninth of a grey level of 255.
vec3 gamma(vec3 color) {
  vec3 root2 = sqrt(color), root4 = sqrt(root2);
  return 0.0334429 * root4 + root2 * (1.241116 - 0.4153707 * root4) + 0.1412364 * color;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);  // fetch: no filtering
  vec4 painted = texelFetch(samplerAlbedo, at, 0);
  vec4 surface = texelFetch(samplerSurface, at, 0);
  float depth = texelFetch(samplerGbufferDepth, at, 0).x;
  vec3 albedo = painted.rgb, normal = unfolded(surface.xy);
  float specular = surface.z, roughness = surface.w, metallic = painted.a;

  // A pinhole camera's inverse projection, without its zeros.
  mat4 unproject = cameraBuffer.projectionMatrixInverse;
  mat4 camera = cameraBuffer.viewMatrixInverse;
  vec2 screen = inUV * 2 - 1;
  vec3 ray = vec3(screen * vec2(unproject[0].x, unproject[1].y) + unproject[3].xy, unproject[3].z);
  vec3 seen = mat3(camera) * (ray / (unproject[2].w * depth + unproject[3].w));
  vec3 place = seen + camera[3].xyz;

  Surface s;
  s.normal = faceforward(normalize(normal), seen, normal);  // both sides of a face are lit
  s.toCamera = -normalize(seen);
  s.facing = dot(s.normal, s.toCamera);
  s.NoV = clamp(s.facing, 1e-6, 1);
  s.diffuse = albedo * ((1 - metallic) / 3.141592653589793f);
  s.fresnel = specular * (1 - metallic) + albedo * metallic;
  float alpha = roughness * roughness;
  s.alpha2 = alpha * alpha;
  s.k = (alpha + 2 * roughness + 1.0) / 8.0;

  vec3 color = sceneBuffer.ambientLight.rgb * albedo;
  for (int i = 0; i < NUM_POINT_LIGHTS; i++) {
    vec3 l = sceneBuffer.pointLights[i].position.xyz - place;
    float fade = 1 / max(dot(l, l), 1e-8);
    color += sceneBuffer.pointLights[i].emission.rgb * fade * reflected(s, l * sqrt(fade));
  }
  for (int i = 0; i < NUM_DIRECTIONAL_LIGHTS; i++) {
    vec3 L = -sceneBuffer.directionalLights[i].direction.xyz;
    vec3 light = sceneBuffer.directionalLights[i].emission.rgb * reflected(s, L);
    color += i < NUM_DIRECTIONAL_LIGHT_SHADOWS ? shadow(i, place) * light : light;
  }
  if (depth == 1) {
    color = sceneBuffer.ambientLight.rgb;
  }
  outColor = vec4(gamma(clamp(color, 0, 1)), 1);
}
"""
