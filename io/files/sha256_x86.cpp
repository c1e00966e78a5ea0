#include "io/files/sha256_blocks.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

#include <cpuid.h>
#include <immintrin.h>

namespace modebank::sha256 {

namespace {

/// Four rounds: `W` holds their message words and constants.
[[gnu::target("sha,sse4.1")]] inline void four_rounds(__m128i& abef, __m128i& cdgh, __m128i W) {
  cdgh = _mm_sha256rnds2_epu32(cdgh, abef, W);
  abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(W, 0x0E));
}

/// The next four message words from the last sixteen, oldest first.
[[gnu::target("sha,sse4.1")]] inline __m128i next_words(__m128i w0, __m128i w1, __m128i w2, __m128i w3) {
  const __m128i sum = _mm_add_epi32(_mm_sha256msg1_epu32(w0, w1), _mm_alignr_epi8(w3, w2, 4));
  return _mm_sha256msg2_epu32(sum, w3);
}

[[gnu::target("sha,sse4.1")]] void compress(__m128i& abef, __m128i& cdgh, const unsigned char* block) {
  const __m128i reverse = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);  // bytes of every word
  const auto* words = reinterpret_cast<const __m128i*>(block);
  const auto* constants = reinterpret_cast<const __m128i*>(round_constants.data());
  __m128i W[4];
  for (int i = 0; i < 4; ++i) W[i] = _mm_shuffle_epi8(_mm_loadu_si128(words + i), reverse);
  const __m128i abef_before = abef, cdgh_before = cdgh;
#pragma GCC unroll 16
  for (int i = 0; i < 16; ++i) {
    four_rounds(abef, cdgh, _mm_add_epi32(W[i % 4], _mm_loadu_si128(constants + i)));
    if (i < 12) W[i % 4] = next_words(W[i % 4], W[(i + 1) % 4], W[(i + 2) % 4], W[(i + 3) % 4]);
  }
  abef = _mm_add_epi32(abef, abef_before);
  cdgh = _mm_add_epi32(cdgh, cdgh_before);
}

/// Asked of the processor, because not every compiler knows the feature by name.
bool has_sha_instructions() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  constexpr unsigned extended_features = 7, sha_bit = 1U << 29;
  return __get_cpuid_count(extended_features, 0, &a, &b, &c, &d) != 0 && (b & sha_bit) != 0;
}

}  // namespace

[[gnu::target("sha,sse4.1")]] bool compress_by_instructions(Sha256::State& H, const unsigned char* blocks,
                                                            std::size_t count) {
  static const bool there = has_sha_instructions() && __builtin_cpu_supports("sse4.1");
  if (!there) return false;
  // The instructions want the words in the order f e b a and h g d c, lowest first.
  auto* state = reinterpret_cast<__m128i*>(H.data());
  const __m128i badc = _mm_shuffle_epi32(_mm_loadu_si128(state), 0xB1);
  const __m128i hgfe = _mm_shuffle_epi32(_mm_loadu_si128(state + 1), 0x1B);
  __m128i abef = _mm_alignr_epi8(badc, hgfe, 8), cdgh = _mm_blend_epi16(hgfe, badc, 0xF0);
  for (std::size_t i = 0; i < count; ++i) compress(abef, cdgh, blocks + i * Sha256::block_bytes);
  const __m128i feba = _mm_shuffle_epi32(abef, 0x1B), dchg = _mm_shuffle_epi32(cdgh, 0xB1);
  _mm_storeu_si128(state, _mm_blend_epi16(feba, dchg, 0xF0));
  _mm_storeu_si128(state + 1, _mm_alignr_epi8(dchg, feba, 8));
  return true;
}

}  // namespace modebank::sha256

#else

bool modebank::sha256::compress_by_instructions(Sha256::State&, const unsigned char*, std::size_t) { return false; }

#endif
