/* A datapath from lines of inputs to lines of outputs, members in the order of the header; what is wrong goes to stderr.
 *
 *   harness DATAPATH PROFILE EFFECTS
 *   harness --names DATAPATH     inputs, then outputs, a name a line */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "roughxel.h"

#define NAME(member) puts(#member);
#define READ(member) if (scanf("%" SCNd32, &in.member) != 1) return 0;
#define WRITE(member) printf("%" PRId32 " ", out.member);

#define DATAPATH(name, IN, OUT) \
  static int name(const roughxel_profile *profile, uint32_t effects) { \
    for (;;) { \
      roughxel_##name##_in in; \
      roughxel_##name##_out out; \
      int32_t error; \
      IN(READ) \
      error = roughxel_##name(profile, effects, &in, &out); \
      if (error != ROUGHXEL_OK) { \
        printf("error %" PRId32 " %" PRId32 "\n", ROUGHXEL_ERROR_KIND(error), ROUGHXEL_ERROR_PLACE(error)); \
        continue; \
      } \
      OUT(WRITE) \
      puts(""); \
    } \
  } \
  static int name##_names(void) { \
    IN(NAME) \
    puts("-"); \
    OUT(NAME) \
    return 0; \
  }

DATAPATH(reflection, ROUGHXEL_REFLECTION_IN_MEMBERS, ROUGHXEL_REFLECTION_OUT_MEMBERS)
DATAPATH(highlight, ROUGHXEL_HIGHLIGHT_IN_MEMBERS, ROUGHXEL_HIGHLIGHT_OUT_MEMBERS)
DATAPATH(peak, ROUGHXEL_PEAK_IN_MEMBERS, ROUGHXEL_PEAK_OUT_MEMBERS)

int main(int count, char **argument) {
  roughxel_profile profile;
  int32_t error;
  uint32_t effects;
  if (roughxel_version() != ROUGHXEL_VERSION) return 2;
  if (count == 3 && strcmp(argument[1], "--names") == 0) {
    if (strcmp(argument[2], "reflection") == 0) return reflection_names();
    return strcmp(argument[2], "highlight") == 0 ? highlight_names() : peak_names();
  }
  if (count != 4) return 2;
  error = roughxel_profile_named(argument[2], &profile);
  if (error != ROUGHXEL_OK) {
    fputs(roughxel_error_text(error), stderr);
    return 1;
  }
  effects = (uint32_t)strtoul(argument[3], NULL, 10);
  if (strcmp(argument[1], "reflection") == 0) return reflection(&profile, effects);
  return strcmp(argument[1], "highlight") == 0 ? highlight(&profile, effects) : peak(&profile, effects);
}
