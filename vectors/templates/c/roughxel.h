/* The scalar datapaths of roughxel: what a device has to compute, to the bit.
 *
 * `roughxel vectors c` writes this file; vectors/README.md says how the library is built, vectors/SPEC.md what it computes.
 *
 * A member of a structure is a field of a vector word, with its name, in its order: the integer that the profile keeps, over
 * 2^fraction bits (vectors/FORMAT.md). Beside each stand its format and its range: I signed, U unsigned, bits before the point,
 * F fraction bits; p is fraction_bits of the profile, l its lod_bits. The value of a mantissa is times 2^e. Inputs that the effects
 * leave out are not read, outcomes that they leave out are constants. What is read has to be in its range all the same: 0 always is.
 *
 * Every function returns ROUGHXEL_OK or an error, and then writes nothing: its kind in the lowest ROUGHXEL_ERROR_BITS bits, and
 * above them the place of the member or knob that is wrong, from 0. No function keeps state, allocates or ends the program; all may
 * be called from any thread. What is written may not overlap what is read. */

#ifndef ROUGHXEL_H
#define ROUGHXEL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of this header; roughxel_version() is that of the library. */
#define ROUGHXEL_VERSION @VERSION@

@ERRORS@
#define ROUGHXEL_ERROR_BITS @ERROR_BITS@
#define ROUGHXEL_ERROR_KIND(error) ((error) & @ERROR_MASK@)
#define ROUGHXEL_ERROR_PLACE(error) ((error) >> @ERROR_BITS@)

/* Effects that are on, a sum of: */
@EFFECTS@

/* The accuracy. */
typedef struct roughxel_profile {
@KNOBS@
} roughxel_profile;

@STRUCTURES@

/* ROUGHXEL_VERSION of the library. */
int32_t roughxel_version(void);
/* What an error is: one line, never freed. */
const char *roughxel_error_text(int32_t error);
/* The knobs of the profile narrow, paper, compact, standard or precise. Errors: NULL, PROFILE. */
int32_t roughxel_profile_named(const char *name, roughxel_profile *profile);

@DATAPATHS@

#ifdef __cplusplus
}
#endif

#endif
