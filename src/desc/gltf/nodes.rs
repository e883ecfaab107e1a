//! The hierarchy of nodes: their placement in the world, and which of them a scene draws.
//!
//! Nodes are visited from a list instead of by recursion, so that no chain of nodes overflows the stack.

use super::super::validate::fits;
use super::animation::Pose;
use super::document::{Document, Node, called, element};
use crate::math::{DAffine3, DMat3, DQuat, DVec3};
use crate::{Error, Result};

/// Where all nodes of a document are.
#[derive(Debug)]
pub(super) struct Nodes {
    /// From the frame of each node to the world.
    pub to_world: Vec<DAffine3>,
    /// The nodes of the scene that is drawn, parents before their children, in the order of the file.
    pub drawn: Vec<usize>,
}

/// Places all nodes in a pose, and lists those of the scene that the document shows.
pub(super) fn place(document: &Document<'_>, pose: &Pose, warnings: &mut Vec<String>) -> Result<Nodes> {
    let nodes = &document.nodes;
    let parents = parents(nodes)?;
    let mut to_world = vec![DAffine3::IDENTITY; nodes.len()];
    let mut seen = vec![false; nodes.len()];
    let mut open: Vec<usize> = (0..nodes.len()).rev().filter(|node| parents[*node].is_none()).collect();
    let roots: Vec<u64> = open.iter().rev().map(|root| *root as u64).collect();
    while let Some(number) = open.pop() {
        let local = local(&format!("nodes[{number}]"), &nodes[number], pose, number)?;
        let parent = parents[number].map_or(DAffine3::IDENTITY, |parent| to_world[parent]);
        to_world[number] = parent * local;
        if !to_world[number].is_finite() {
            return Err(Error::invalid(format!("nodes[{number}]"), "its transform overflows, expected finite numbers"));
        }
        seen[number] = true;
        open.extend(nodes[number].children.iter().map(|child| *child as usize));
    }
    if let Some(number) = seen.iter().position(|seen| !seen) {
        let message = "the node is its own ancestor: the nodes form a cycle";
        return Err(Error::invalid(called(&format!("nodes[{number}]"), nodes[number].name.as_deref()), message));
    }
    let (path, scene_roots) = match (document.scene, document.scenes.as_slice()) {
        (Some(index), scenes) => {
            let (number, scene) = element(scenes, "scenes", "scene", index)?;
            (format!("scenes[{number}].nodes"), &scene.nodes)
        }
        (None, [scene, ..]) => ("scenes[0].nodes".to_owned(), &scene.nodes),
        (None, []) => {
            super::warn(warnings, "the file has no scene; all of its nodes are drawn".to_owned());
            (String::new(), &roots)
        }
    };
    let drawn_scene = document.scene.unwrap_or(0);
    if document.scenes.len() > 1 {
        let others = document.scenes.iter().enumerate().filter(|(i, _)| *i as u64 != drawn_scene);
        let others = others.map(|(i, scene)| called(&format!("scenes[{i}]"), scene.name.as_deref()));
        let message = format!("scenes[{drawn_scene}] is drawn; others are left out: {}", super::listed(others));
        super::warn(warnings, message);
    }
    let (mut drawn, mut is_drawn) = (Vec::new(), vec![false; nodes.len()]);
    for (i, index) in scene_roots.iter().enumerate() {
        let path = format!("{path}[{i}]");
        let (root, _) = element(nodes, "nodes", &path, *index)?;
        if let Some(parent) = parents[root] {
            let message = format!("nodes[{root}] is a child of nodes[{parent}], expected a node without a parent");
            return Err(Error::invalid(path, message));
        }
        open.push(root);
        while let Some(number) = open.pop() {
            if !std::mem::replace(&mut is_drawn[number], true) {
                drawn.push(number);
                open.extend(nodes[number].children.iter().rev().map(|child| *child as usize));
            }
        }
    }
    Ok(Nodes { to_world, drawn })
}

/// The parent of each node. Every node has one at most.
fn parents(nodes: &[Node<'_>]) -> Result<Vec<Option<usize>>> {
    let mut parents = vec![None; nodes.len()];
    for (number, node) in nodes.iter().enumerate() {
        for (i, child) in node.children.iter().enumerate() {
            let path = format!("nodes[{number}].children[{i}]");
            let (child, _) = element(nodes, "nodes", &path, *child)?;
            if let Some(parent) = parents[child].replace(number) {
                let message = format!("nodes[{child}] is a child of nodes[{parent}] too, expected one parent");
                return Err(Error::invalid(path, message));
            }
        }
    }
    Ok(parents)
}

/// From the frame of a node to that of its parent.
fn local(path: &str, node: &Node<'_>, pose: &Pose, number: usize) -> Result<DAffine3> {
    let at = |key: &str| format!("{path}.{key}");
    let animated = pose.of(number);
    let is_animated =
        animated.is_some_and(|it| it.translation.is_some() || it.rotation.is_some() || it.scale.is_some());
    if let Some(m) = node.matrix {
        if is_animated {
            return Err(Error::invalid(
                at("matrix"),
                "an animation changes the node, expected translation, rotation and scale",
            ));
        }
        if let Some(i) = m.iter().position(|number| !fits(*number)) {
            return Err(Error::invalid(at(&format!("matrix[{i}]")), format!("{} is beyond single precision", m[i])));
        }
        let last = [m[3], m[7], m[11], m[15]];
        if last != [0.0, 0.0, 0.0, 1.0] {
            let message =
                format!("its last row is {last:?}, expected [0, 0, 0, 1]: the matrix is given column by column");
            return Err(Error::invalid(at("matrix"), message));
        }
        let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
        return Ok(DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(4), column(8)), column(12)));
    }
    let animated = animated.copied().unwrap_or_default();
    let vector = |key: &str, animated: Option<DVec3>, given: Option<[f64; 3]>, default: DVec3| {
        let value = animated.or(given.map(DVec3::from_array)).unwrap_or(default);
        super::super::validate::vector(&at(key), value)
    };
    let translation = vector("translation", animated.translation, node.translation, DVec3::ZERO)?;
    let scale = vector("scale", animated.scale, node.scale, DVec3::ONE)?;
    let rotation = animated.rotation.unwrap_or_else(|| node.rotation.map_or(DQuat::IDENTITY, DQuat::from_array));
    Ok(DAffine3::from_scale_rotation_translation(scale, unit(&at("rotation"), rotation)?, translation))
}

/// The rotation of a quaternion that was rounded.
fn unit(path: &str, rotation: DQuat) -> Result<DQuat> {
    let length = rotation.length();
    if length > 1e-6 && length.is_finite() {
        return Ok(rotation / length);
    }
    Err(Error::invalid(path, format!("{:?} is no rotation, expected a unit quaternion", rotation.to_array())))
}
