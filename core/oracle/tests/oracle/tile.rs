//! The tile of a picture that the firmware draws.

use roughxel_core::firmware::{Narrow, Standard};
use roughxel_core::precision::Profile;

#[expect(unreachable_pub, reason = "firmware draws it, too")]
pub(crate) mod drawn;

use drawn::{HASHES, Hash, shade};

pub(crate) fn the_tile_hashes_to_what_it_does_on_every_machine() {
    for (profile, expected) in HASHES {
        // One accuracy of each word width: other accuracies run the same code.
        let hash = match profile {
            Profile::Narrow => shade::<Narrow>(),
            Profile::Standard => shade::<Standard>(),
            _ => continue,
        };
        assert_eq!(hash, Hash(expected), "{}: {:#010x}", profile.name(), hash.0);
    }
}
