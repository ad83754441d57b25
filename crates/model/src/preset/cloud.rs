//! Scenes of points and lines alone: the plain look of them, and what effects cannot show of them.

use super::Preset;
use crate::{
    effects::Effect,
    scene::{
        Scene,
        model::{Primitive, Topology},
        parts::Scope,
    },
};

/// What a scene without triangles draws beside its ground and walls; none where it has triangles.
fn spread(scene: &Scene) -> Option<Vec<&Primitive>> {
    let shown = scene.instances.len() - scene.walls - scene.grounds;
    let instances = scene.instances.iter().take(shown);
    let drawn: Vec<&Primitive> = instances
        .map(|instance| &scene.primitives[instance.primitive])
        .collect();
    (shown > 0 && drawn.iter().all(|primitive| primitive.is_spread())).then_some(drawn)
}

impl Preset {
    /// Suits the plain look to a scene of points and lines alone: light falls on the ground, and on
    /// what has normals and no color; where points are, what hides the sky darkens them.
    pub fn suit_cloud(&mut self, scene: &Scene) {
        let drawn = spread(scene).filter(|_| self.stack.get("ambient").is_none());
        let Some(drawn) = drawn else { return };
        let mut each = drawn.iter();
        let is_lit = each.all(|p| p.colors.is_none() && p.normals.stride > 0);
        // Surveys have a class of the name, which is a node.
        let ground = Scope::of_texts(&["material:ground".to_owned()]).unwrap_or_default();
        let colors = ["studio", "tonemap", "shadow"].into_iter();
        for name in colors.filter(|_| !is_lit).chain(["fog"]) {
            if let Some(effect) = self.stack.get_mut(name) {
                effect.on = ground.clone();
            }
        }
        if drawn.iter().any(|primitive| primitive.is_points()) {
            let ambient = self.stack.enable(Effect::named("ambient"));
            ambient.set("radius_m", &[0.02]).set("strength", &[1.6]);
        }
    }
}

impl Effect {
    /// Why it may show nothing of its own: one of its loops never ends, or the scene has only points or
    /// lines. A sentence.
    pub fn why_idle(&self, scene: &Scene) -> Option<&'static str> {
        if self
            .source
            .as_ref()
            .is_some_and(|source| source.has_endless_loop)
        {
            return Some(
                "A loop of it has neither break nor return: it is ended after 4096 turns.",
            );
        }
        let drawn = spread(scene)?;
        let has_lines = drawn.iter().any(|p| p.topology == Topology::Lines);
        let has_normals = drawn.iter().any(|p| p.normals.stride > 0);
        match self.name.as_str() {
            "wireframe" => Some("Points and lines have no edges of triangles to be drawn."),
            "facet" => Some("Points and lines have no planes on which light could fall."),
            "dots" if !has_lines => Some(
                "Points have no edges for dots to follow; a polyline (lines=polyline) is followed.",
            ),
            "inflate" if !has_normals => {
                Some("The points of this scene have no normals to move along.")
            }
            _ => None,
        }
    }
}
