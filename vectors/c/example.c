/* The reflection of a plain mirror in profile standard, and how many a second the library computes.
 *
 *   cc -O2 -I vectors/c vectors/c/example.c target/c-library/c-library/libroughxel_c.a -o example && ./example [COUNT] */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "roughxel.h"

int main(int count, char **argument) {
  const long repeats = count > 1 ? strtol(argument[1], NULL, 10) : 1000000;
  const uint32_t effects = ROUGHXEL_BUMP | ROUGHXEL_ROUGHNESS | ROUGHXEL_CURVATURE | ROUGHXEL_FOOTPRINT;
  roughxel_profile profile;
  roughxel_reflection_in in = {0};
  roughxel_reflection_out out;
  int32_t error;
  uint32_t sum = 0;
  long i;
  clock_t start;
  double seconds;

  error = roughxel_profile_named("standard", &profile);
  if (error == ROUGHXEL_OK) {
    /* 1.0 in I2Fp: a normal along z, an eye above it, at a slant, the frame of x and y. */
    const int32_t one = (int32_t)1 << profile.fraction_bits;
    in.normal_z = one;
    in.view_x = one / 2;
    in.view_z = one;
    in.frame_vectors_0_x = one;
    in.frame_vectors_1_y = one;
    error = roughxel_reflection(&profile, effects, &in, &out);
  }
  if (error != ROUGHXEL_OK) {
    fprintf(stderr, "%s (place %" PRId32 ")\n", roughxel_error_text(error), ROUGHXEL_ERROR_PLACE(error));
    return 1;
  }
  printf("reflected (%" PRId32 ", %" PRId32 ", %" PRId32 ") * 2^%" PRId32 " / 2^%" PRId32 "\n", out.reflected_x,
         out.reflected_y, out.reflected_z, out.reflected_e, profile.fraction_bits);

  start = clock();
  for (i = 0; i < repeats; ++i) {
    in.offset_1 = (int32_t)(i % 4096);
    if (roughxel_reflection(&profile, effects, &in, &out) != ROUGHXEL_OK) return 1;
    sum += (uint32_t)out.reflected_x;
  }
  seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
  printf("%ld reflections in %.2f s: %.2f million a second (sum %" PRIu32 ")\n", repeats, seconds,
         (double)repeats / (seconds > 0 ? seconds : 1) / 1e6, sum);
  return 0;
}
