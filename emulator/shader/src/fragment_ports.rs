//! Fragments as a device takes them after its maps are sampled: the ports of the reflection datapath, and the surface's own colour.

use roughxel_core::ports::{BlockVector, Port, SurfaceInput};

use crate::batch::Batch;
use crate::fragments::{Fragments, Place};
use crate::material::{Channel, Material};
use crate::pass::Shader;
use crate::signals::{Derivatives, ports};

/// A fragment with its maps sampled.
#[derive(Clone, Copy, Debug)]
pub struct FragmentPorts {
    /// Pixel of the fragment.
    pub place: Place,
    /// Ports of the surface; zeros if the object has none.
    pub surface: SurfaceInput<i32>,
    /// Derivatives over a pixel; zeros if the object has no footprint.
    pub derivatives: Derivatives<i32>,
    /// Colour of the object at the fragment.
    pub colour: [Channel; 3],
}

impl Shader<'_> {
    /// Takes the waiting fragments of an object as ports, with their maps sampled and nothing reflected or lit.
    pub fn fragment_ports(self, material: &Material, fragments: &mut Fragments) -> Vec<FragmentPorts> {
        let (mut colours, mut bumps) = (Batch::default(), Batch::default());
        fragments.footprints.make(self, &fragments.duv);
        self.colours(material, fragments, &mut colours);
        self.bumps(material, fragments, &mut bumps);
        let none = BlockVector::default().wires();
        let flat = Derivatives { dview: [none; 2], dnormal: [none; 2] };
        let bare = crate::SurfaceAttributes { normal: none, view: none, frame_vectors: [none; 2] };
        let each = fragments.places.iter().zip(colours.colours()).enumerate();
        let ports = each.map(|(index, (&place, colour))| {
            let bare = if fragments.bare.len() > index { fragments.bare.get(index) } else { bare };
            let derivatives = if fragments.derivatives.len() > index { fragments.derivatives.get(index) } else { flat };
            FragmentPorts { place, surface: ports(&bare, &bumps.get(index).bump), derivatives, colour }
        });
        let ports = ports.collect();
        fragments.clear();
        ports
    }
}
