// kernels/path/shade.comp in C++, for W paths at a time in vectors, or one: what shade_roofline measures the kernel
// against.
//
// It follows the GLSL formula by formula, with its names and in the order of its files, for what the Cornell box has:
// Lambert surfaces, triangle lights picked by power, whole nets, a picture made of 8x8 tiles; no textures, no
// environment.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "kernels/base/frame_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/path/path_types.h"

#ifdef __clang__
#pragma clang diagnostic ignored "-Wbitwise-instead-of-logical" // of one lane
#endif

namespace wavepath {

// How records are stored: in rows of 16 bytes; word by word and lane by lane, each with a test, as Mesa's driver does;
// or not at all.
enum class Stores { rows, words, none };

// A wave when it comes to shade, and the scene.
struct ShadeInput {
  gpu::Frame frame;
  gpu::Wave wave;
  std::vector<gpu::Ray> rays;
  std::vector<std::uint32_t> sorted_rays; // places of those that hit
  std::vector<gpu::Hit> hits;
  std::vector<gpu::PathState> paths;
  std::vector<gpu::Triangle> triangles;
  std::vector<gpu::Material> materials;
  std::vector<gpu::Light> lights;
};

// Each with room for one record more than there are slots.
struct ShadeOutput {
  std::vector<gpu::PathState> paths; // updated
  std::vector<gpu::Ray> rays;
  std::vector<gpu::ShadowRay> shadow_rays;
  std::atomic<std::uint32_t> ray_count = 0, shadow_count = 0;
};

// GCC 12 drops the attribute in other places where it depends on W.
template <int W>
struct LaneTypes {
  typedef float F __attribute__((vector_size(4 * W)));
  typedef std::uint32_t U __attribute__((vector_size(4 * W)));
  typedef std::int32_t M __attribute__((vector_size(4 * W))); // a mask: 0 or -1
  typedef std::uint64_t Wide __attribute__((vector_size(8 * W)));
};
template <> // GCC 12 miscompiles vectors of one
struct LaneTypes<1> {
  using F = float;
  using U = std::uint32_t;
  using M = bool;
  using Wide = std::uint64_t;
};

template <int W, Stores kStores>
class ShadeLanes {
public:
  ShadeLanes(const ShadeInput& input, ShadeOutput& output) : in_(input), frame_(input.frame), out_(output) {}

  // Of these rays, counted among those that hit.
  void shade(std::uint32_t first, std::uint32_t end) {
    for (; first < end; first += W) shade_lanes(first, end);
  }

private:
  using F = typename LaneTypes<W>::F;
  using U = typename LaneTypes<W>::U;
  using M = typename LaneTypes<W>::M;
  using Wide = typename LaneTypes<W>::Wide;
  using Row = float __attribute__((vector_size(16)));
  using TwoRows = float __attribute__((vector_size(32)));

  struct Vec3 {
    F x, y, z;
    Vec3 operator+(const Vec3& b) const { return {x + b.x, y + b.y, z + b.z}; }
    Vec3 operator-(const Vec3& b) const { return {x - b.x, y - b.y, z - b.z}; }
    Vec3 operator*(const Vec3& b) const { return {x * b.x, y * b.y, z * b.z}; }
    Vec3 operator*(F s) const { return {x * s, y * s, z * s}; }
    Vec3 operator/(F s) const { return {x / s, y / s, z / s}; }
    Vec3 operator-() const { return {-x, -y, -z}; }
  };
  struct Texel {
    F x, y, z, w;
    Vec3 xyz() const { return {x, y, z}; }
  };
  struct Bits2 {
    U x, y;
  };
  struct Surface {
    Vec3 position, error, normal;
    U material, light;
  };
  struct Sampler {
    U scramble, index;
  };
  struct Vertex {
    Surface surface;
    Vec3 facing, normal, base;
    F diffuse_probability;
    U slot;
  };

  // ---- GLSL's functions

  static F splat(float x) { return F{} + x; }
  static U splat(std::uint32_t x) { return U{} + x; }
  static U bits(F x) { return std::bit_cast<U>(x); }
  static F floats(U x) { return std::bit_cast<F>(x); }
  template <class To>
  static To convert(const auto& x) {
    if constexpr (W == 1)
      return static_cast<To>(x);
    else
      return __builtin_convertvector(x, To);
  }
  static F to_float(U x) { return convert<F>(x); }
  static U to_uint(F x) { return convert<U>(x); }
  static auto lane(const auto& x, [[maybe_unused]] int i) {
    if constexpr (W == 1)
      return x;
    else
      return x[i];
  }
  // of_lane(i) for every lane.
  static U each(const auto& of_lane) {
    std::array<std::uint32_t, W> values;
    for (int i = 0; i < W; ++i) values[i] = of_lane(i);
    return std::bit_cast<U>(values);
  }
  static bool any(M m) {
    bool some = false;
    for (int i = 0; i < W; ++i) some |= lane(m, i) != 0;
    return some;
  }
  static F root(F x) {
    if constexpr (W == 1)
      return std::sqrt(x);
    else {
      for (int i = 0; i < W; ++i) x[i] = std::sqrt(x[i]);
      return x;
    }
  }
  static F larger(F a, F b) { return a > b ? a : b; }
  static F smaller(F a, F b) { return a < b ? a : b; }
  static U smaller(U a, U b) { return a < b ? a : b; }
  static F magnitude(F x) { return floats(bits(x) & 0x7fffffffu); }
  static Vec3 magnitude(const Vec3& v) { return {magnitude(v.x), magnitude(v.y), magnitude(v.z)}; }
  static F dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  static F max_component(const Vec3& v) { return larger(v.x, larger(v.y, v.z)); }
  static Vec3 select(M m, const Vec3& a, const Vec3& b) { return {m ? a.x : b.x, m ? a.y : b.y, m ? a.z : b.z}; }
  static Vec3 normalize(const Vec3& v) { return v / root(dot(v, v)); }
  static M is_finite(F x) { return (bits(x) & 0x7f800000u) != 0x7f800000u; }
  static M is_finite(const Vec3& v) { return is_finite(v.x) & is_finite(v.y) & is_finite(v.z); }

  // ---- records.glsl, path/queue.glsl

  // Row `row` of a record for each lane.
  template <class Record>
  static Texel load(const std::vector<Record>& records, U index, int row) {
    const char* first = reinterpret_cast<const char*>(records.data()) + 16 * row;
    const auto at = [&](int i) { return first + sizeof(Record) * lane(index, i); };
    Texel t;
    if constexpr (W == 1) {
      std::memcpy(&t, at(0), 16);
    } else {
      TwoRows columns[4][W / 8];
      for (int block = 0; block < W / 8; ++block) {
        TwoRows pairs[4]; // lanes i and i + 4
        for (int i = 0; i < 4; ++i) {
          Row low, high;
          std::memcpy(&low, at(8 * block + i), 16);
          std::memcpy(&high, at(8 * block + i + 4), 16);
          pairs[i] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
        }
        transpose(pairs);
        for (int word = 0; word < 4; ++word) columns[word][block] = pairs[word];
      }
      t = {whole(columns[0]), whole(columns[1]), whole(columns[2]), whole(columns[3])};
    }
    return t;
  }
  static F whole(const TwoRows* blocks) {
    if constexpr (W == 16)
      return __builtin_shufflevector(blocks[0], blocks[1], 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    else
      return std::bit_cast<F>(blocks[0]);
  }
  // A 4x4 matrix in either half.
  static void transpose(TwoRows* p) {
    const TwoRows a = __builtin_shufflevector(p[0], p[1], 0, 8, 1, 9, 4, 12, 5, 13),
                  b = __builtin_shufflevector(p[0], p[1], 2, 10, 3, 11, 6, 14, 7, 15),
                  c = __builtin_shufflevector(p[2], p[3], 0, 8, 1, 9, 4, 12, 5, 13),
                  d = __builtin_shufflevector(p[2], p[3], 2, 10, 3, 11, 6, 14, 7, 15);
    p[0] = __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
    p[1] = __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
    p[2] = __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
    p[3] = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
  }

  template <class Record>
  static void store(std::vector<Record>& records, U index, M wanted, int row, const Texel& t) {
    char* first = reinterpret_cast<char*>(records.data()) + 16 * row;
    const auto spare = static_cast<std::uint32_t>(records.size() - 1);
    if constexpr (kStores == Stores::none) {
      asm volatile("" ::"m"(t), "m"(index), "m"(wanted));
    } else if constexpr (kStores == Stores::words) {
      std::uint32_t end = spare;
      Texel words = t;
      asm volatile("" : "+m"(words), "+m"(index), "+m"(wanted)); // in memory: a loop runs over the lanes
#pragma GCC unroll 1
      for (int i = 0; i < W; ++i) {
        if (!reinterpret_cast<const std::int32_t*>(&wanted)[i]) continue;
        for (int word = 0; word < 4; ++word) {
          asm volatile("" : "+m"(end));
          const std::uint32_t place = reinterpret_cast<const std::uint32_t*>(&index)[i];
          if (place >= end) continue;
          std::memcpy(first + sizeof(Record) * place + 4 * word, reinterpret_cast<const float*>(&words) + W * word + i,
                      4);
        }
      }
    } else { // what is not wanted goes to the spare record, by threads in any order: no branches, nobody reads it
      const U place = wanted ? index : splat(spare);
      const auto at = [&](int i) { return first + sizeof(Record) * lane(place, i); };
      if constexpr (W == 1) {
        std::memcpy(at(0), &t, 16);
      } else {
        TwoRows columns[4][W / 8];
        std::memcpy(columns, &t, sizeof t);
        for (int block = 0; block < W / 8; ++block) {
          TwoRows pairs[4] = {columns[0][block], columns[1][block], columns[2][block], columns[3][block]};
          transpose(pairs);
          for (int i = 0; i < 8; ++i)
            std::memcpy(at(8 * block + i), reinterpret_cast<const char*>(&pairs[i & 3]) + 16 * (i >> 2), 16);
        }
      }
    }
  }

  // Places in a queue for the lanes that want one.
  static U append(std::atomic<std::uint32_t>& count, M wanted) {
    if constexpr (W == 1) {
      return wanted ? count.fetch_add(1, std::memory_order_relaxed) : 0;
    } else {
      const U ones = std::bit_cast<U>(wanted) & 1u;
      U sums = ones; // of the lane and those before it
      sums += before<1>(sums);
      sums += before<2>(sums);
      sums += before<4>(sums);
      if constexpr (W == 16) sums += before<8>(sums);
      return sums - ones + (sums[W - 1] > 0 ? count.fetch_add(sums[W - 1], std::memory_order_relaxed) : 0);
    }
  }
  template <int kBy>
  static U before(U x) {
    return [&]<int... i>(std::integer_sequence<int, i...>) {
      return __builtin_shufflevector(U{}, x, (i < kBy ? 0 : W + i - kBy)...);
    }
    (std::make_integer_sequence<int, W>());
  }

  // ---- sampler.glsl, pixel.glsl

  static void pcg3d(U& x, U& y, U& z) {
    x = x * 1664525u + 1013904223u;
    y = y * 1664525u + 1013904223u;
    z = z * 1664525u + 1013904223u;
    for (int round = 0; round < 2; ++round) {
      x += y * z;
      y += z * x;
      z += x * y;
      if (round == 1) break;
      x ^= x >> 16u;
      y ^= y >> 16u;
      z ^= z >> 16u;
    }
  }
  static U scramble_reversed(U x, U seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
  }
  static U sobol_reversed(U i) {
    i ^= (i >> 1u) & 0x55555555u;
    i ^= (i >> 2u) & 0x33333333u;
    i ^= (i >> 4u) & 0x0f0f0f0fu;
    i ^= (i >> 8u) & 0x00ff00ffu;
    i ^= i >> 16u;
    return i;
  }
  static U bitfield_reverse(U x) {
    x = ((x >> 1u) & 0x55555555u) | ((x & 0x55555555u) << 1u);
    x = ((x >> 2u) & 0x33333333u) | ((x & 0x33333333u) << 2u);
    x = ((x >> 4u) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4u);
    x = ((x >> 8u) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8u);
    return (x >> 16u) | (x << 16u);
  }
  static Bits2 sample_bits(const Sampler& s, std::uint32_t dimension) {
    U x = s.scramble, y = splat(dimension), z = splat(0x9e3779b9u);
    pcg3d(x, y, z);
    const U i = bitfield_reverse(scramble_reversed(bitfield_reverse(s.index), z));
    return {bitfield_reverse(scramble_reversed(i, x)), bitfield_reverse(scramble_reversed(sobol_reversed(i), y))};
  }
  static F unit_float(U x) { return to_float(x >> 8u) * 5.9604645e-8f; }
  // For a < 2^24 and b > 1: the quotient of floats is one off at most.
  static U divide(U a, std::uint32_t b) {
    const U quotient = to_uint(to_float(a) * (1.0f / static_cast<float>(b))), rest = a - quotient * b;
    return rest >= 0x80000000u ? quotient - 1u : rest >= b ? quotient + 1u : quotient;
  }
  Sampler slot_sampler(U slot) const {
    const U sample = divide(slot, in_.wave.pixel_count),
            place = slot - sample * in_.wave.pixel_count + in_.wave.first_pixel;
    const U tile_row = divide(place, 8 * frame_.width), in_row = place - tile_row * (8 * frame_.width);
    const U x = (in_row & 1u) | ((in_row >> 1u) & 2u) | ((in_row >> 2u) & 4u);
    const U y = ((in_row >> 1u) & 1u) | ((in_row >> 2u) & 2u) | ((in_row >> 3u) & 4u);
    U scramble = splat(frame_.seed), replicate{};
    U pixel = (8u * tile_row + y) * frame_.width + 8u * (in_row >> 6u) + x;
    pcg3d(scramble, pixel, replicate);
    return {scramble, sample + in_.wave.first_sample};
  }

  // ---- math.glsl

  static constexpr float kInvPi = 0.318309886183791f, kOneMinusEpsilon = 0.99999994f;

  static Vec3 safe_normalize(const Vec3& v, const Vec3& fallback) {
    const F scale = max_component(magnitude(v));
    return select((scale > 0.0f) & is_finite(scale), normalize(v / scale), fallback);
  }
  static void make_basis(const Vec3& n, Vec3& tangent, Vec3& bitangent) {
    const F s = n.z < 0.0f ? splat(-1.0f) : splat(1.0f), a = -1.0f / (s + n.z), b = n.x * n.y * a;
    tangent = {1.0f + s * n.x * n.x * a, s * b, -s * n.x};
    bitangent = {b, s + n.y * n.y * a, -n.y};
  }
  static F signed_unit(F u) {
    const F x = (2.0f * u - 1.0f) + 5.9604645e-8f;
    return smaller(larger(x, splat(-kOneMinusEpsilon)), splat(kOneMinusEpsilon));
  }
  static Vec3 warp_cosine_hemisphere(F u, F v) {
    const F x = signed_unit(u), y = signed_unit(v);
    const M steep = magnitude(y) > magnitude(x);
    const F r = steep ? y : x, turns = 0.125f * (steep ? x : y) / r, q = turns * turns;
    const F c = 1.0f + q * (-19.7392087f + q * (64.9393265f + q * (-85.4437418f + q * 59.2459684f)));
    const F s = turns * (6.28318529f + q * (-41.3416627f + q * (81.5925586f + q * -75.4022499f)));
    const F dx = r * (steep ? s : c), dy = r * (steep ? c : s);
    return {dx, dy, root(larger(1.0f - (dx * dx + dy * dy), splat(1e-7f)))};
  }
  static F next_towards(F x, F offset) {
    const U b = bits(x);
    const U up = b == 0x80000000u ? splat(1u) : b < 0x80000000u ? b + 1u : b - 1u;
    const U down = b == 0u ? splat(0x80000001u) : b < 0x80000000u ? b - 1u : b + 1u;
    const F moved = offset > 0.0f ? floats(up) : offset < 0.0f ? floats(down) : x;
    return is_finite(x) ? moved : x;
  }
  static Vec3 offset_ray_origin(const Surface& s, const Vec3& w) {
    const F distance = dot(magnitude(s.normal), s.error);
    const Vec3 offset = s.normal * (dot(w, s.normal) < 0.0f ? -distance : distance), q = s.position + offset;
    return {next_towards(q.x, offset.x), next_towards(q.y, offset.y), next_towards(q.z, offset.z)};
  }

  // ---- surface.glsl, emission.glsl, intervals.glsl

  Surface fetch_surface(U triangle, F b1, F b2) const {
    constexpr float kGamma7 = 7 * 5.9604645e-8f / (1.0f - 7 * 5.9604645e-8f);
    const Texel v0 = load(in_.triangles, triangle, 0), v1 = load(in_.triangles, triangle, 1),
                v2 = load(in_.triangles, triangle, 2);
    const Vec3 p0 = v0.xyz() * (1.0f - b1 - b2), p1 = v1.xyz() * b1, p2 = v2.xyz() * b2;
    const Vec3 normal = cross(v1.xyz() - v0.xyz(), v2.xyz() - v0.xyz());
    return {p0 + p1 + p2, (magnitude(p0) + magnitude(p1) + magnitude(p2)) * splat(kGamma7),
            safe_normalize(normal, {F{}, F{}, splat(1.0f)}), bits(v0.w) & gpu::kTriangleMaterialMask, bits(v2.w)};
  }
  Vec3 surface_emission(U material, M front) const {
    const Texel emission_flags = load(in_.materials, material, 1);
    const M shines = front | ((bits(emission_flags.w) & gpu::kMaterialDoubleSided) != 0u);
    return select(shines, emission_flags.xyz(), Vec3{});
  }
  static F solid_angle_pdf(F pdf_area, const Vec3& to_light, const Vec3& n) {
    const F d2 = dot(to_light, to_light), cosine = magnitude(dot(to_light, n)) / root(d2);
    return cosine > 0.0f ? pdf_area * d2 / cosine : F{};
  }
  static F mis_weight(F pdf, F other) {
    const F ratio = other / pdf;
    return 1.0f / (1.0f + ratio * ratio);
  }
  U pick_light(U& u) const {
    const U pick = smaller(u, splat(0xfffffffeu));
    U index{}, begin{}, end = splat(0xffffffffu), beyond = splat(frame_.light_count - 1);
    for (M searches = index < beyond; any(searches); searches = index < beyond) {
      const U middle = (index + beyond) >> 1u;
      const U middle_end = each([&](int i) { return in_.lights[lane(middle, i)].end; });
      const M below = searches & (pick < middle_end), above = searches & (pick >= middle_end);
      beyond = below ? middle : beyond;
      end = below ? middle_end : end;
      index = above ? middle + 1u : index;
      begin = above ? middle_end : begin;
    }
    u = stretch(pick - begin, end - begin);
    return index;
  }
  static U stretch(U offset, U width) {
    const F width_ = to_float(width);
    const U quotient = to_uint(smaller(to_float(offset) * (4294967296.0f / width_), splat(4294967040.0f)));
    const Wide rest = (convert<Wide>(offset) << 32) - convert<Wide>(quotient) * convert<Wide>(width);
    U high = convert<U>(rest >> 32), low = convert<U>(rest);
    const M above = high >= 0x80000000u;
    high = above ? ~high : high;
    low = above ? ~low : low;
    const U correction = to_uint(smaller((to_float(high) * 4294967296.0f + to_float(low)) / width_, splat(4096.0f)));
    return above ? quotient - smaller(correction + 1u, quotient) : quotient + smaller(correction, ~quotient);
  }

  // ---- path/shade.comp

  static M sides_agree(const Vertex& v, const Vec3& wi) {
    return (dot(wi, v.facing) > 0.0f) == (dot(wi, v.normal) > 0.0f);
  }

  void connect_to_light(const Vertex& v, Bits2 u, const Vec3& throughput, M wanted) {
    const U light = pick_light(u.x);
    const Texel links = load(in_.lights, light, 3);
    const F ux = unit_float(u.x), uy = unit_float(u.y);
    const M lower = ux < uy;
    const Surface there =
        fetch_surface(bits(links.y), lower ? 0.5f * ux : ux - 0.5f * uy, lower ? uy - 0.5f * ux : 0.5f * uy);
    const Vec3 offset = there.position - v.surface.position, wi = normalize(offset);
    const Vec3 emitted = surface_emission(there.material, dot(there.normal, wi) < 0.0f);
    const F density = solid_angle_pdf(links.x, offset, there.normal), up = larger(dot(wi, v.normal), F{});
    const F weight = mis_weight(density, v.diffuse_probability * (up * kInvPi));
    const Vec3 contribution = throughput * (v.base * (kInvPi * up)) * emitted * (weight / density);
    wanted &= (max_component(emitted) > 0.0f) & (density > 0.0f) & sides_agree(v, wi) &
              ((is_finite(contribution) == M{}) | (max_component(contribution) > 0.0f));
    const Vec3 origin = offset_ray_origin(v.surface, wi), direction = offset_ray_origin(there, -wi) - origin;
    const U place = append(out_.shadow_count, wanted);
    store(out_.shadow_rays, place, wanted, 0, {origin.x, origin.y, origin.z, floats(v.slot)});
    store(out_.shadow_rays, place, wanted, 1, {direction.x, direction.y, direction.z, splat(1.0f)});
    store(out_.shadow_rays, place, wanted, 2, {contribution.x, contribution.y, contribution.z, floats(light)});
  }

  void scatter(const Vertex& v, const Sampler& sampler, std::uint32_t dimension, Vec3& throughput, F& bsdf_pdf,
               Vec3& radiance, M wanted) {
    const Bits2 u = sample_bits(sampler, dimension);
    const Vec3 drawn = warp_cosine_hemisphere(unit_float(u.x), unit_float(u.y));
    Vec3 tangent, bitangent;
    make_basis(v.normal, tangent, bitangent);
    const Vec3 wi = normalize(tangent * drawn.x + bitangent * drawn.y + v.normal * drawn.z);
    const F pdf = v.diffuse_probability * (drawn.z * kInvPi);
    wanted &= (pdf > 0.0f) & is_finite(pdf) & sides_agree(v, wi);
    throughput = select(wanted, throughput * v.base, throughput);
    bsdf_pdf = wanted ? pdf : bsdf_pdf;
    if (in_.wave.bounce > 1) {
      const F survival = root(max_component(throughput)); // eta_scale is 1
      const F u_survival = unit_float(sample_bits(sampler, dimension + 1).y);
      wanted &= (survival >= 1.0f) | (u_survival < survival);
      throughput = select(wanted & (survival < 1.0f), throughput / survival, throughput);
    }
    wanted &= max_component(throughput) > 0.0f;
    const Vec3 origin = offset_ray_origin(v.surface, wi);
    const M sound = is_finite(throughput) & is_finite(origin) & is_finite(wi);
    const F poisoned = splat(std::numeric_limits<float>::quiet_NaN());
    radiance = select(wanted & (sound == M{}), {poisoned, poisoned, poisoned}, radiance);
    wanted &= sound;
    const U place = append(out_.ray_count, wanted);
    store(out_.rays, place, wanted, 0, {origin.x, origin.y, origin.z, floats(v.slot)});
    store(out_.rays, place, wanted, 1, {wi.x, wi.y, wi.z, splat(gpu::kFar)});
  }

  [[gnu::flatten]] void shade_lanes(std::uint32_t first, std::uint32_t end) {
    const U index = each([&](int i) { return first + static_cast<std::uint32_t>(i); });
    const U place = each([&](int i) { return in_.sorted_rays[lane(index, i) < end ? lane(index, i) : first]; });
    const Texel origin_slot = load(in_.rays, place, 0), direction_t = load(in_.rays, place, 1),
                hit = load(in_.hits, place, 0);
    const U slot = bits(origin_slot.w);
    const Texel throughput_pdf = load(out_.paths, slot, 0), radiance_eta = load(out_.paths, slot, 1);
    Vec3 throughput = throughput_pdf.xyz(), radiance = radiance_eta.xyz();
    F bsdf_pdf = throughput_pdf.w;
    const M live = (index < end) & is_finite(radiance);

    Vertex v{.surface = fetch_surface(bits(hit.x), hit.z, hit.w), .slot = slot};
    v.base = load(in_.materials, v.surface.material, 0).xyz();
    const Vec3 wo = -direction_t.xyz();
    const M front = dot(v.surface.normal, wo) >= 0.0f;
    v.facing = select(front, v.surface.normal, -v.surface.normal);
    const F seen = dot(v.facing, wo); // held_normal()
    v.normal = select(seen < 1e-3f, normalize(v.facing + wo * (1e-3f - seen)), v.facing);
    const F luminance = dot(v.base, {splat(0.2126f), splat(0.7152f), splat(0.0722f)});
    v.diffuse_probability = luminance > 0.0f ? splat(1.0f) : F{};

    const Vec3 emitted = surface_emission(v.surface.material, front);
    if (const M shines = max_component(emitted) > 0.0f; any(shines)) {
      const M no_light = v.surface.light == gpu::kNone;
      const F pdf_area = load(in_.lights, no_light ? U{} : v.surface.light, 3).x;
      const F light_pdf = solid_angle_pdf(pdf_area, v.surface.position - origin_slot.xyz(), v.surface.normal);
      const M alone = no_light | (bsdf_pdf < 0.0f) | (light_pdf <= 0.0f);
      const F weight = alone ? splat(1.0f) : mis_weight(bsdf_pdf, light_pdf);
      radiance = select(shines, radiance + throughput * emitted * weight, radiance);
    }
    const M goes_on = live & (dot(wo, v.normal) > 0.0f);
    if (in_.wave.bounce < frame_.max_depth && any(goes_on)) {
      const Sampler sampler = slot_sampler(slot);
      const std::uint32_t dimension = 1 + 3 * in_.wave.bounce;
      connect_to_light(v, sample_bits(sampler, dimension + 2), throughput, goes_on);
      scatter(v, sampler, dimension, throughput, bsdf_pdf, radiance, goes_on);
    }
    store(out_.paths, slot, live, 0, {throughput.x, throughput.y, throughput.z, bsdf_pdf});
    store(out_.paths, slot, live, 1, {radiance.x, radiance.y, radiance.z, radiance_eta.w});
  }

  const ShadeInput& in_;
  const gpu::Frame& frame_;
  ShadeOutput& out_;
};

} // namespace wavepath
