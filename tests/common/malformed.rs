//! Scene files that must be refused, each with the beginning of the expected error.
//!
//! An entry is (name, text, expected): `expected` is a part of the error's text with line, JSON path and the beginning
//! of the message, as in `7: surfaces[0].radius: -1 is not above 0`.

/// A file in parts; `@` marks the position that must be reported and is removed.
struct List(Vec<(String, String, String)>);

impl List {
    /// A whole text.
    fn text(&mut self, name: &str, text: &str, expected: &str) {
        let mark = text.find('@').unwrap_or(0);
        let line = 1 + text[..mark].matches('\n').count();
        self.0.push((name.to_owned(), text.replacen('@', "", 1), format!("{line}: {expected}")));
    }

    /// A native scene with a camera, a material named white, and `more` at the top level.
    fn top(&mut self, name: &str, more: &str, expected: &str) {
        let text = format!(
            "{{\n \"etendue\": 1,\n \"camera\": {{\"origin\": [0, 0, \
             5]}},\n \"materials\": [\n  {{\"name\": \"white\", \
             \"type\": \"diffuse\", \"color\": [0.5, 0.5, 0.5]}}\n ],\n {more}\n}}\n"
        );
        self.text(name, &text, expected);
    }

    /// A native scene with this surface.
    fn surface(&mut self, name: &str, surface: &str, expected: &str) {
        let text = format!(
            "\"surfaces\": [\n  {{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1,\n\
             \"material\": \"white\"}},\n  {surface}\n ]"
        );
        self.top(name, &text, expected);
    }

    /// A native scene with a sphere with `more`.
    fn sphere(&mut self, name: &str, more: &str, expected: &str) {
        let text = format!(
            "{{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1, \"material\": \"white\",\n   {more}}}"
        );
        self.surface(name, &text, expected);
    }

    /// A native scene with a quad of these corners.
    fn quad(&mut self, name: &str, corners: [&str; 4], expected: &str) {
        let [a, b, c, d] = corners;
        let text = format!(
            "@{{\"geometry\": \"quad\", \"material\": \"white\",\n   \"vertex-1\": {a},\n   \"vertex-2\": {b},\n   \
             \"vertex-3\": {c},\n   \"vertex-4\": {d}}}"
        );
        self.surface(name, &text, expected);
    }

    /// A native scene with a second material.
    fn material(&mut self, name: &str, material: &str, expected: &str) {
        let text = format!(
            "{{\"etendue\": 1, \"camera\": {{}},\n \"materials\": [\n  {{\"name\": \"white\", \"type\": \"diffuse\", \
             \"color\": [1, 1, 1]}},\n  {material}\n ]}}"
        );
        self.text(name, &text, expected);
    }

    /// A native scene with this camera.
    fn camera(&mut self, name: &str, camera: &str, expected: &str) {
        self.text(name, &format!("{{\n \"etendue\": 1,\n \"camera\": {camera}\n}}\n"), expected);
    }

    /// A scene of the report's renderer with `more` at the top level.
    fn mcrt(&mut self, name: &str, more: &str, expected: &str) {
        let text = format!(
            "{{\n \"camera\": {{\"origin\": [-1, 0, 0], \"lookAt\": [1, 0, \
             0]}},\n \"materials\": [\n  {{\"name\": \"white\", \
             \"type\": \"diffuse\", \"brdf\": \"lambertian\", \"color\": [1, 1, 1],\n   \"refractionIndex\": 0, \
             \"reflectionRate\": 0.75}}],\n {more}\n}}\n"
        );
        self.text(name, &text, expected);
    }
}

/// The list.
pub fn malformed() -> Vec<(String, String, String)> {
    let mut list = List(Vec::new());
    texts(&mut list);
    cameras(&mut list);
    motions(&mut list);
    renders(&mut list);
    materials(&mut list);
    lights(&mut list);
    backplates(&mut list);
    surfaces(&mut list);
    placements(&mut list);
    meshes(&mut list);
    quadrics(&mut list);
    reports(&mut list);
    list.0
}

fn texts(l: &mut List) {
    l.text("empty", "", "the text ends inside a value");
    l.text("blank", "  \n\n@", "the text ends inside a value");
    l.text("not JSON", "\n\n@scene = 3", "expected value");
    l.text("cut off", "{\n \"etendue\": 1,\n \"camera\": {@", "the text ends inside an object");
    l.text("cut off in a string", "{\n \"etendue\": 1,\n \"cam@", "the text ends inside a string");
    l.text("trailing comma", "{\n \"etendue\": 1,\n \"camera\": {},\n@}", "key must be a string");
    l.text("missing comma", "{\n \"etendue\": 1\n @\"camera\": {}\n}", "expected `,` or `}`");
    l.text("two documents", "{\"etendue\": 1, \"camera\": {}}\n@{}", "trailing characters");
    l.text("comment", "{\n @// a comment\n \"etendue\": 1, \"camera\": {}}", "key must be a string");
    l.text("NaN", "{\"etendue\": 1, \"camera\": {\n@\"fieldOfView\": NaN}}", "expected value");
    l.text("infinity", "{\"etendue\": 1, \"camera\": {\n@\"fieldOfView\": Infinity}}", "expected value");
    l.text("leading zero", "{\"etendue\": 1, \"camera\": {\n@\"fieldOfView\": 090}}", "invalid number");
    l.text("leading plus", "{\"etendue\": 1, \"camera\": {\n@\"fieldOfView\": +90}}", "expected value");
    l.text("control character", "{\"etendue\": 1,\n \"descr@\tiption\": 1}", "control character");
    l.text("bad escape", "{\"etendue\": 1,\n \"a@\\qb\": 1}", "invalid escape");
    l.text("array at the top", "\n@[{}]", "expected an object, found an array");
    l.text("number at the top", "1", "expected an object, found a number");
    l.text("string at the top", "\"scene\"", "expected an object, found a string");
    l.text("null at the top", "null", "expected an object, found null");
    l.text("newer version", "{\n@\"etendue\": 2}", "etendue: the scene is of format version 2");
    l.text("version null", "{\n@\"etendue\": null}", "etendue: expected the number 1, found null");
    l.text("version string", "{\n@\"etendue\": \"1\"}", "etendue: expected the number 1, found a string");
    l.text("version twice", "{\"etendue\": 1,\n@\"etendue\": 1, \"camera\": {}}", "etendue: key given twice");
    l.text("no camera", "\n@{\"etendue\": 1}", "missing key `camera`");
    l.top("unknown key at the top", "@\"surface\": []", "surface: unknown key `surface`");
    l.top("unknown key with a hint", "@\"surface\": []", "surface: unknown key `surface`, expected one of");
    l.top("key of the top twice", "\"lights\": [],\n @\"lights\": []", "lights: key given twice");
    l.top("surfaces not an array", "@\"surfaces\": {}", "surfaces: invalid type: an object, expected an array");
    l.top("lights not an array", "@\"lights\": 3", "lights: invalid type: integer `3`, expected an array");
    l.top("meshes not an array", "@\"meshes\": \"m\"", "meshes: invalid type: string \"m\", expected an array");
    l.top("description not a string", "@\"description\": 3", "description: invalid type");
    // The nesting is deeper than any stack allows, in a part of the file that is not used.
    l.top("nested deeply", &format!("@\"deep\": {}{}", "[".repeat(100_000), "]".repeat(100_000)), "deep: unknown key");
    l.top(
        "surfaces nested deeply",
        &format!("\"surfaces\": [\n@{}{}]", "[".repeat(9999), "]".repeat(9999)),
        "surfaces[0]: expected an object",
    );
    l.text(
        "unclosed arrays",
        &format!("{{\n \"surfaces\":\n @{}", "[".repeat(100_000)),
        "the text ends inside an array",
    );
    l.top("endless name", &format!("@\"{}\": 1", "x".repeat(100_000)), "xxx");
}

fn motions(l: &mut List) {
    l.camera("shutter a number", "{\n@\"shutter\": 1}", "camera.shutter: invalid type: integer `1`");
    l.camera(
        "shutter that closes first",
        "{\"shutter\": {\"open\": 1,\n@\"close\": 0.5}}",
        "camera.shutter.close: 0.5 is before",
    );
    l.camera(
        "shutter beyond single precision",
        "{\"shutter\": {\n@\"open\": 1e39}}",
        "camera.shutter.open: 1e39 is beyond",
    );
    l.camera(
        "unknown curve",
        "{\"shutter\": {\n@\"curve\": \"round\"}}",
        "camera.shutter.curve: no curve of a shutter",
    );
    l.camera(
        "curve of one number",
        "{\"shutter\": {\n@\"curve\": [1]}}",
        "camera.shutter.curve: 1 numbers, expected 2 to 1024",
    );
    l.camera(
        "curve of no number",
        "{\"shutter\": {\n@\"curve\": []}}",
        "camera.shutter.curve: 1 numbers, expected 2 to 1024",
    );
    l.camera("curve below 0", "{\"shutter\": {\"curve\": [1,\n@-1]}}", "camera.shutter.curve[1]: -1 is negative");
    l.camera(
        "curve of zeros",
        "{\"shutter\": {\n@\"curve\": [0, 0]}}",
        "camera.shutter.curve: the shutter is never open",
    );
    l.camera(
        "unknown key of a shutter",
        "{\"shutter\": {\n@\"opens\": 1}}",
        "camera.shutter.opens: unknown key `opens`",
    );
    l.camera("no keyframe", "{\n@\"motion\": []}", "camera.motion: 0 keys, expected 1 to 10000");
    l.camera("keyframe without time", "{\"motion\": [\n@{}]}", "camera.motion[0]: missing key `time`");
    l.camera(
        "camera stretched",
        "{\"motion\": [{\"time\": 0},\n@{\"time\": 1, \"scale\": 2}]}",
        "camera.motion[1]: a camera is not stretched",
    );
    l.camera(
        "camera mirrored",
        "{\"motion\": [\n@{\"time\": 1, \"scale\": -1}]}",
        "camera.motion[0]: a camera is not stretched or mirrored",
    );
    l.sphere(
        "keys out of order",
        "\"motion\": [{\"time\": 1}, {\n@\"time\": 0.5}]",
        "surfaces[1].motion[1].time: 0.5 is not later than the key before",
    );
    l.sphere(
        "keys of one time",
        "\"motion\": [{\"time\": 1}, {\n@\"time\": 1}]",
        "surfaces[1].motion[1].time: 1 is not later than the key before",
    );
    l.sphere(
        "time beyond single precision",
        "\"motion\": [{\n@\"time\": -1e39}]",
        "surfaces[1].motion[0].time: -1e39 is beyond",
    );
    l.sphere(
        "two rotations",
        "\"motion\": [{\"time\": 0, \"rotate\": [0, 0, 1],\n@\"quaternion\": [0, 0, 0, 1]}]",
        "surfaces[1].motion[0].quaternion: the rotation is given by `rotate`",
    );
    l.sphere(
        "axis without angle",
        "\"motion\": [\n@{\"time\": 0, \"axis\": [0, 0, 1]}]",
        "surfaces[1].motion[0]: missing key `angle`",
    );
    l.sphere(
        "angle without axis",
        "\"motion\": [\n@{\"time\": 0, \"angle\": 1}]",
        "surfaces[1].motion[0]: missing key `axis`",
    );
    l.sphere(
        "axis of length 0",
        "\"motion\": [{\"time\": 0, \"angle\": 1,\n@\"axis\": [0, 0, 0]}]",
        "surfaces[1].motion[0].axis: [0.0, 0.0, 0.0] has no direction",
    );
    l.sphere("half a turn between keys", "\"motion\": [{\"time\": 0, \"axis\": [0, 0, 1], \"angle\": 0}, {\"time\": 1, \"axis\": [0, 0, 1],\n@\"angle\": 180}]", "surfaces[1].motion[1].angle: 180 degrees after 0 are half a turn");
    l.sphere(
        "no rotation",
        "\"motion\": [{\"time\": 0,\n@\"quaternion\": [0, 0, 0, 0]}]",
        "surfaces[1].motion[0].quaternion: [0.0, 0.0, 0.0, 0.0] is no rotation",
    );
    l.sphere(
        "scale of 0 in a key",
        "\"motion\": [{\"time\": 0,\n@\"scale\": [1, 0, 1]}]",
        "surfaces[1].motion[0].scale: a scale of 0 flattens",
    );
    l.sphere(
        "matrix and more",
        "\"motion\": [{\"time\": 0, \"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],\n@\"translate\": [1, 0, 0]}]",
        "surfaces[1].motion[0].translate: `matrix` stands alone",
    );
    l.sphere(
        "matrix by columns",
        "\"motion\": [{\"time\": 0,\n@\"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,0,0,1]}]",
        "surfaces[1].motion[0].matrix: the last row is",
    );
    l.sphere(
        "flat matrix",
        "\"motion\": [{\"time\": 0,\n@\"matrix\": [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,0,1]}]",
        "surfaces[1].motion[0].matrix: the transform cannot be undone",
    );
    l.sphere(
        "flattened in between",
        "\"motion\": [{\"time\": 0},\n@{\"time\": 1, \"scale\": [-1, 1, 1]}]",
        "surfaces[1].motion[1]: the object is flattened between the keys 0 and 1",
    );
    let mesh = |steps: &str| {
        format!(
            "{{\"geometry\": \"mesh\", \"material\": \"white\", \"positions\": [[0,0,0],[1,0,0],[0,1,0]], \"triangles\": [[0,1,2]], \"steps\": {steps}}}"
        )
    };
    let still = "\"positions\": [[0,0,0],[1,0,0],[0,1,0]]";
    l.surface(
        "no steps",
        "@{\"geometry\": \"mesh\", \"material\": \"white\", \"steps\": []}",
        "surfaces[1]: the mesh has no triangles",
    );
    l.surface(
        "step of two vertices",
        &mesh("[{\"time\": 0,\n@\"positions\": [[0,0,0],[1,0,0]]}]"),
        "surfaces[1].steps[0].positions: 2 positions for 3 vertices",
    );
    l.surface(
        "steps out of order",
        &mesh(&format!("[{{\"time\": 0, {still}}}, {{\n@\"time\": 0, {still}}}]")),
        "surfaces[1].steps[1].time: 0 is not later",
    );
    l.surface(
        "normals of one step",
        &mesh(&format!(
            "[{{\"time\": 0, {still}}}, {{\"time\": 1, {still},\n@\"normals\": [[0,0,1],[0,0,1],[0,0,1]]}}]"
        )),
        "surfaces[1].steps[1].normals: some steps have normals",
    );
    l.surface(
        "step beyond single precision",
        &mesh("[{\"time\": 0, \"positions\": [[0,0,0],[1,\n@1e39,0],[0,1,0]]}]"),
        "surfaces[1].steps[0].positions[1][1]: 1e39 is beyond",
    );
    l.top("light flattened", "\"lights\": [{\"type\": \"point\", \"origin\": [0, 0, 0], \"color\": [1, 1, 1], \"motion\": [{\"time\": 0,\n@\"scale\": 0}]}]", "lights[0].motion[0].scale: a scale of 0 flattens");
}

fn cameras(l: &mut List) {
    l.camera("camera null", "@null", "camera: expected an object, found null");
    l.camera("camera array", "@[[0, 0, 0]]", "camera: expected an object, found an array");
    l.camera("camera number", "@1", "camera: expected an object, found a number");
    l.camera(
        "origin of two",
        "{\n  @\"origin\": [0, 0]}",
        "camera.origin: wrong length 2, expected an array of length 3",
    );
    l.camera("origin of four", "{\n  @\"origin\": [0, 0, 0, 0]}", "camera.origin: too many elements");
    l.camera(
        "origin a number",
        "{\n  @\"origin\": 0}",
        "camera.origin: invalid type: integer `0`, expected an array of length 3",
    );
    l.camera(
        "origin of strings",
        "{\"origin\": [0,\n  @\"0\", 0]}",
        "camera.origin[1]: invalid type: string \"0\", expected a number",
    );
    l.camera(
        "origin with null",
        "{\"origin\": [0, 0,\n  @null]}",
        "camera.origin[2]: invalid type: null, expected a number",
    );
    l.camera("overflow", "{\"origin\": [0, 0,\n  @1e999]}", "camera.origin[2]: the number is too large");
    l.camera(
        "beyond single precision",
        "{\"origin\": [0, 0,\n  @1e39]}",
        "camera.origin[2]: 1e39 is beyond single precision",
    );
    l.camera("field of view 0", "{\n@\"fieldOfView\": 0}", "camera.fieldOfView: 0 degrees are out of range");
    l.camera("field of view negative", "{\n@\"fieldOfView\": -30}", "camera.fieldOfView: -30 degrees");
    l.camera("field of view 180", "{\n@\"fieldOfView\": 180.0}", "camera.fieldOfView: 180 degrees");
    l.camera(
        "field of view string",
        "{\n@\"fieldOfView\": \"90\"}",
        "camera.fieldOfView: invalid type: string \"90\", expected a number",
    );
    l.camera(
        "looks at itself",
        "{\"origin\": [1, 2, 3],\n@\"lookAt\": [1, 2, 3]}",
        "camera.lookAt: [1, 2, 3] is the camera's origin",
    );
    l.camera("up is zero", "{\n@\"up\": [0, 0, 0]}", "camera.up: the vector is zero");
    l.camera("up along the view", "{\n@\"up\": [0, 0, -3]}", "camera.up: the vector is parallel to the view");
    l.camera("up nearly along the view", "{\n@\"up\": [1e-9, 0, 1]}", "camera.up: the vector is parallel to the view");
    l.camera("unknown camera key", "{\n@\"fov\": 90}", "camera.fov: unknown key `fov`");
    l.camera(
        "mistyped camera key",
        "{\n@\"lookat\": [0, 0, 0]}",
        "camera.lookat: unknown key `lookat`, expected one of `type`",
    );
    l.camera("camera key twice", "{\"up\": [0, 1, 0],\n@\"up\": [0, 1, 0]}", "camera.up: key given twice");
    l.camera("unknown camera", "{\n@\"type\": \"periscope\"}", "camera.type: unknown name `periscope`");
    l.camera("camera type number", "{\n@\"type\": 1}", "camera.type: invalid type: integer `1`");
    l.camera("camera type object", "{\n@\"type\": {\"perspective\": null}}", "camera.type: invalid type: an object");
    l.camera(
        "unknown axis",
        "{\n@\"fieldOfViewAxis\": \"diagonal\"}",
        "camera.fieldOfViewAxis: unknown name `diagonal`",
    );
    l.camera(
        "view plane with vertical angle",
        "{\"type\": \"view-plane\",\n@\"fieldOfViewAxis\": \"vertical\"}",
        "camera.fieldOfViewAxis: a view-plane camera's field of view is horizontal",
    );
    for (name, keys, expected) in [
        ("negative lens", "@\"lensRadius\": -0.5", "lensRadius: -0.5 is negative, expected a radius > 0"),
        ("lens beyond single precision", "@\"lensRadius\": 1e39", "lensRadius: 1e39 is beyond single precision"),
        ("lens by a string", "@\"lensRadius\": \"1\"", "lensRadius: invalid type: string \"1\""),
        ("stop alone", "@\"fStop\": 2", "fStop: says nothing of a size by itself, expected `focalLength` with it"),
        ("focal length alone", "@\"focalLength\": 0.05", "focalLength: gives the size of the lens only with `fStop`"),
        ("stop of 0", "@\"fStop\": 0, \"focalLength\": 1", "fStop: 0 is not above 0"),
        ("negative focal length", "\"fStop\": 2,\n@\"focalLength\": -1", "focalLength: -1 is not above 0"),
        (
            "radius and stop",
            "\"lensRadius\": 1,\n@\"fStop\": 2",
            "fStop: the size of the lens is given by `lensRadius`",
        ),
        (
            "radius and focal length",
            "\"lensRadius\": 1,\n@\"focalLength\": 2",
            "focalLength: the size of the lens is given by `lensRadius`",
        ),
        ("focus of a pinhole", "@\"focusDistance\": 2", "focusDistance: a pinhole has no aperture"),
        ("blades of a pinhole", "@\"blades\": 6", "blades: a pinhole has no aperture"),
        ("focus at 0", "\"lensRadius\": 1,\n@\"focusDistance\": 0", "focusDistance: 0 is not above 0"),
        ("focus behind", "\"lensRadius\": 1,\n@\"focusDistance\": -2", "focusDistance: -2 is not above 0"),
        (
            "focus at a point behind",
            "\"lensRadius\": 1,\n@\"focusAt\": [0, 3, 2]",
            "focusAt: [0, 3, 2] is -2 from the camera along the view direction, expected a point in front of it",
        ),
        (
            "focus beside",
            "\"lensRadius\": 1,\n@\"focusAt\": [3, 0, 0]",
            "focusAt: [3, 0, 0] is 0 from the camera along the view direction",
        ),
        (
            "focus at two places",
            "\"lensRadius\": 1, \"focusDistance\": 1,\n@\"focusAt\": [0, 0, -1]",
            "focusAt: the plane",
        ),
        ("focus far away", "\"lensRadius\": 1,\n@\"focusAt\": [0, 0, -1e39]", "focusAt[2]: -1e39 is beyond"),
        (
            "one blade",
            "\"lensRadius\": 1,\n@\"blades\": 1",
            "blades: an aperture has no 1 blades, expected 0 for a round one",
        ),
        ("two blades", "\"lensRadius\": 1,\n@\"blades\": 2", "blades: an aperture has no 2 blades"),
        (
            "many blades",
            "\"lensRadius\": 1,\n@\"blades\": 33",
            "blades: 33 is out of range, expected a whole number from 0",
        ),
        ("half a blade", "\"lensRadius\": 1,\n@\"blades\": 5.5", "blades: invalid value: floating point `5.5`"),
        ("blades turned too far", "\"lensRadius\": 1,\n@\"bladeRotation\": 1e39", "bladeRotation: 1e39 is beyond"),
        (
            "squeeze of 0",
            "\"lensRadius\": 1,\n@\"squeeze\": 0",
            "squeeze: 0 is out of range, expected a number in [0.01, 100]",
        ),
        ("width of an angle", "@\"width\": 3", "width: a perspective camera spans an angle, expected `fieldOfView`"),
        (
            "lens of a view plane",
            "\"type\": \"view-plane\",\n@\"lensRadius\": 0.1",
            "lensRadius: a view-plane camera has no lens, expected a perspective one",
        ),
        (
            "height of a view plane",
            "\"type\": \"view-plane\",\n@\"height\": 3",
            "height: a view-plane camera spans an angle",
        ),
        (
            "blades of parallel rays",
            "\"type\": \"orthographic\", \"width\": 1,\n@\"blades\": 5",
            "blades: an orthographic camera has no lens",
        ),
        (
            "angle of parallel rays",
            "\"type\": \"orthographic\", \"width\": 1,\n@\"fieldOfView\": 40",
            "fieldOfView: the rays of an orthographic camera are parallel, expected `width` or `height`",
        ),
        (
            "two sizes of parallel rays",
            "\"type\": \"orthographic\", \"width\": 1,\n@\"height\": 1",
            "height: follows from `width` and the resolution",
        ),
        (
            "angle of all directions",
            "\"type\": \"spherical\",\n@\"fieldOfView\": 360",
            "fieldOfView: a spherical camera sees all directions, expected no angle",
        ),
        (
            "axis of a cylinder",
            "\"type\": \"cylindrical\",\n@\"fieldOfViewAxis\": \"vertical\"",
            "fieldOfViewAxis: the angle of a cylindrical camera spans the width",
        ),
        (
            "cylinder beyond a turn",
            "\"type\": \"cylindrical\",\n@\"fieldOfView\": 361",
            "fieldOfView: 361 degrees are out of range, expected an angle above 0 and up to 360",
        ),
        (
            "fisheye of no angle",
            "\"type\": \"fisheye\",\n@\"fieldOfView\": 0",
            "fieldOfView: 0 degrees are out of range",
        ),
        ("shifted too far", "@\"shift\": [0, 101]", "shift[1]: 101 is out of range, expected a number in [-100, 100]"),
        ("shift of one number", "@\"shift\": [0.5]", "shift: wrong length 1, expected an array of length 2"),
        (
            "shift of a fisheye",
            "\"type\": \"fisheye\",\n@\"shift\": [0, 0]",
            "shift: a fisheye camera has no film to shift, expected a perspective or orthographic one",
        ),
        (
            "shift of a view plane",
            "\"type\": \"view-plane\",\n@\"shift\": [0, 0.5]",
            "shift: a view-plane camera has no film to shift",
        ),
        (
            "pixels without width",
            "@\"pixelAspect\": 0",
            "pixelAspect: 0 is out of range, expected a number in [0.01, 100]",
        ),
        (
            "negative pixels of a cylinder",
            "\"type\": \"cylindrical\",\n@\"pixelAspect\": -1",
            "pixelAspect: -1 is out of range",
        ),
        (
            "pixels of all directions",
            "\"type\": \"spherical\",\n@\"pixelAspect\": 1",
            "pixelAspect: a spherical camera spreads all directions over any resolution",
        ),
        (
            "pixels of a view plane",
            "\"type\": \"view-plane\",\n@\"pixelAspect\": 2",
            "pixelAspect: the plane of a view-plane camera follows from the resolution alone",
        ),
        (
            "lens of a fisheye",
            "\"type\": \"fisheye\",\n@\"lensRadius\": 0.1",
            "lensRadius: a fisheye camera has no lens",
        ),
        ("width of 0", "\"type\": \"orthographic\",\n@\"width\": 0", "width: 0 is not above 0"),
        ("negative height", "\"type\": \"orthographic\",\n@\"height\": -1", "height: -1 is not above 0"),
    ] {
        l.camera(name, &format!("{{\n{keys}}}"), &format!("camera.{expected}"));
    }
    l.camera(
        "parallel rays without a size",
        "@{\"type\": \"orthographic\"}",
        "camera: missing key `width`, or `height`",
    );
}

fn renders(l: &mut List) {
    for (name, block, expected) in [
        ("resolution of 0", "@\"resolution\": [0, 64]", "resolution"),
        ("crop of three", "@\"crop\": [0, 0, 3]", "crop: wrong length 3"),
        (
            "crop of no pixel",
            "@\"crop\": [0, 0, 0, 4]",
            "crop[2]: 0 is out of range, expected a whole number from 1 to 256",
        ),
        (
            "crop beyond the picture",
            "\"resolution\": [8, 6],\n@\"crop\": [2, 5, 6, 2]",
            "crop[3]: 2 is out of range, expected a whole number from 1 to 1",
        ),
        ("resolution of one", "@\"resolution\": [64]", "resolution: wrong length 1"),
        ("resolution of three", "@\"resolution\": [64, 64, 3]", "resolution: too many elements"),
        ("resolution broken", "\"resolution\": [64,\n@64.5]", "resolution[1]: invalid value: floating point `64.5`"),
        ("resolution negative", "\"resolution\": [\n@-64, 64]", "resolution[0]: invalid value: integer `-64`"),
        ("resolution huge", "@\"resolution\": [100000, 100000]", "resolution: 100000 x 100000 pixels are too many"),
        (
            "resolution beyond 32 bits",
            "\"resolution\": [\n@4294967297, 1]",
            "resolution[0]: 4294967297 is out of range",
        ),
        ("no samples", "@\"samples\": 0", "samples: 0 is out of range, expected a whole number from 1"),
        ("too many samples", "@\"samples\": 2147483649", "samples: 2147483649 is out of range"),
        ("half a sample", "@\"samples\": 0.5", "samples: invalid value: floating point `0.5`"),
        ("samples string", "@\"samples\": \"64\"", "samples: invalid type: string \"64\", expected a whole number"),
        ("unknown sampler", "@\"sampler\": \"sobel\"", "sampler: unknown name `sobel`"),
        (
            "unknown filter",
            "@\"filter\": \"gaussain\"",
            "filter: unknown name 'gaussain', expected one of box, tent, gaussian, \
             blackman-harris, mitchell; did you mean 'gaussian'?",
        ),
        ("unknown filter type", "\"filter\": {\n@\"type\": \"bx\"}", "filter.type: unknown type 'bx'"),
        ("filter without type", "@\"filter\": {\"sigma\": 1}", "filter: missing key `type`"),
        ("filter number", "@\"filter\": 1", "filter: expected an object, found a number"),
        (
            "filter with foreign key",
            "\"filter\": {\"type\": \"box\",\n@\"sigma\": 1}",
            "filter.sigma: unknown key `sigma`",
        ),
        ("sigma 0", "\"filter\": {\"type\": \"gaussian\",\n@\"sigma\": 0}", "filter.sigma: 0 is not above 0"),
        ("sigma huge", "\"filter\": {\"type\": \"gaussian\",\n@\"sigma\": 17}", "filter.sigma: 17 is out of range"),
        ("mitchell b", "\"filter\": {\"type\": \"mitchell\",\n@\"b\": -1}", "filter.b: -1 is out of range"),
        ("depth 0", "@\"maxDepth\": 0", "maxDepth: 0 is out of range"),
        ("depth huge", "@\"maxDepth\": 1e10", "maxDepth: 10000000000 is out of range"),
        ("no shadow rays", "@\"shadowRays\": 0", "shadowRays: 0 is out of range"),
        ("unknown roulette", "@\"roulette\": \"files\"", "roulette: unknown name `files`"),
        ("roulette object", "@\"roulette\": {\"type\": \"own\"}", "roulette: "),
        ("unknown integrator", "@\"integrator\": \"bdpt\"", "integrator: unknown name 'bdpt'"),
        (
            "unknown integrator type",
            "\"integrator\": {\n@\"type\": \"whited\"}",
            "integrator.type: unknown type 'whited', \
             expected one of path, whitted, direct, photon_direct, caustic, photon, irradiance_cache, radiosity, ppm, sppm, auto; \
             did you mean 'whitted'?",
        ),
        (
            "integrator with more",
            "\"integrator\": {\"type\": \"path\",\n@\"depth\": 3}",
            "integrator.depth: unknown key",
        ),
        (
            "reuse as a number",
            "\"integrator\": {\"type\": \"path\",\n@\"reuse\": 1}",
            "integrator.reuse: invalid type: integer `1`, expected a boolean",
        ),
        (
            "light paths as a text",
            "\"integrator\": {\"type\": \"path\",\n@\"lightPaths\": \"on\"}",
            "integrator.lightPaths: invalid type: string \"on\", expected a boolean",
        ),
        (
            "no light samples first",
            "\"integrator\": {\"type\": \"path\",\n@\"firstShadowRays\": 0}",
            "integrator.firstShadowRays: 0 is out of range, expected a whole number from 1 to 1024",
        ),
        (
            "a bias that is no name",
            "\"integrator\": {\"type\": \"auto\",\n@\"bias\": true}",
            "integrator.bias: invalid type: boolean `true`, expected a string",
        ),
        (
            "an unknown name of a bias",
            "\"integrator\": {\"type\": \"auto\",\n@\"bias\": \"small\"}",
            "integrator.bias: unknown name `small`, expected `refused` or `allowed`",
        ),
        ("reuse beside the integrator", "\"integrator\": \"path\",\n@\"reuse\": true", "reuse: unknown key"),
        ("seed negative", "@\"seed\": -1", "seed: invalid value: integer `-1`"),
        (
            "no photons",
            "@\"photonCount\": 0",
            "photonCount: 0 is out of range, expected a whole number from 1 to 536870912",
        ),
        ("too many photons", "@\"photonCount\": 536870913", "photonCount: 536870913 is out of range"),
        ("photons negative", "@\"photon_count\": -1", "photon_count: invalid value: integer `-1`"),
        ("photons beyond 32 bits", "@\"photon_count\": 4294967297", "photon_count: 4294967297 is out of range"),
        ("photons twice", "\"photonCount\": 1,\n@\"photon_count\": 1", "photon_count: the key is given twice"),
        ("radius 0", "@\"photonRadius\": 0", "photonRadius: 0 is not above 0"),
        ("radius negative", "@\"photon_radius\": -1", "photon_radius: -1 is not above 0"),
        (
            "radius huge",
            "@\"photonRadius\": 1e30",
            "photonRadius: 1e30 is out of range, expected a radius in [1e-18, 1e18]",
        ),
        ("radius tiny", "@\"photon_radius\": 1e-19", "photon_radius: 1e-19 is out of range"),
        ("radius beyond single precision", "@\"photonRadius\": 1e39", "photonRadius: 1e39 is beyond single precision"),
        ("radius NaN", "@\"photonRadius\": \"NaN\"", "photonRadius: invalid type: string \"NaN\", expected a number"),
        ("radius twice", "\"photonRadius\": 1,\n@\"photon_radius\": 1", "photon_radius: the key is given twice"),
        ("no photons at least", "@\"minPhotons\": 0", "minPhotons: 0 is out of range"),
        ("least twice", "\"minPhotons\": 1,\n@\"min_photons\": 2", "min_photons: the key is given twice"),
        ("no caustic photons", "@\"causticCount\": 0", "causticCount: 0 is out of range"),
        ("caustic radius", "@\"causticRadius\": -0.0", "causticRadius: -0 is not above 0"),
        ("neighbours 1", "@\"photonNeighbours\": 1", "photonNeighbours: 1 is out of range"),
        ("neighbours", "@\"photonNeighbours\": 65537", "photonNeighbours: 65537 is out of range"),
        (
            "unknown kernel",
            "@\"photonKernel\": \"con\"",
            "photonKernel: unknown name 'con', expected one of flat, cone, epanechnikov; did you mean 'cone'?",
        ),
        ("unknown kernel type", "\"photonKernel\": {\n@\"type\": \"box\"}", "photonKernel.type: unknown type 'box'"),
        ("flat kernel with k", "\"photonKernel\": {\"type\": \"flat\",\n@\"k\": 1}", "photonKernel.k: unknown key `k`"),
        (
            "cone below 1",
            "\"photonKernel\": {\"type\": \"cone\",\n@\"k\": 0.99}",
            "photonKernel.k: 0.99 is out of range, expected a number >= 1",
        ),
        (
            "cone huge",
            "\"photonKernel\": {\"type\": \"cone\",\n@\"k\": 1e39}",
            "photonKernel.k: 1e39 is beyond single precision",
        ),
        ("alpha 0", "@\"photonAlpha\": 0", "photonAlpha: 0 is out of range, expected a number above 0 and below 1"),
        ("alpha 1", "@\"photonAlpha\": 1", "photonAlpha: 1 is out of range"),
        ("unknown sharing", "@\"photonSharing\": \"areas\"", "photonSharing: unknown name `areas`"),
        ("guided number", "@\"photonsGuided\": 1", "photonsGuided: invalid type: integer `1`, expected a boolean"),
        ("progressive name", "@\"photonsProgressive\": \"no\"", "photonsProgressive: invalid type: string \"no\""),
        ("no gather rays", "@\"gatherRays\": 0", "gatherRays: 0 is out of range"),
        (
            "gather rays",
            "@\"gatherRays\": 1025",
            "gatherRays: 1025 is out of range, expected a whole number from 1 to 1024",
        ),
        ("no photon memory", "@\"photonMemory\": 0", "photonMemory: 0 is out of range"),
        ("photon memory", "@\"photonMemory\": 1048577", "photonMemory: 1048577 is out of range"),
        (
            "cache error 0",
            "@\"cacheError\": 0",
            "cacheError: 0 is out of range, expected a number above 0 and up to 10",
        ),
        ("cache error", "@\"cacheError\": 10.5", "cacheError: 10.5 is out of range"),
        ("cache error tiny", "@\"cacheError\": 1e-40", "cacheError: 0.0000"),
        (
            "cache rays",
            "@\"cacheRays\": 15",
            "cacheRays: 15 is out of range, expected a whole number from 16 to 1048576",
        ),
        ("cache rays many", "@\"cacheRays\": 1048577", "cacheRays: 1048577 is out of range"),
        ("spacing 0", "@\"cacheMinSpacing\": 0", "cacheMinSpacing: 0 is out of range"),
        ("spacing", "@\"cacheMinSpacing\": 1001", "cacheMinSpacing: 1001 is out of range"),
        ("spacing of nothing", "@\"cacheMaxSpacing\": 0", "cacheMaxSpacing: 0 is out of range"),
        ("spacing beyond the scene", "@\"cacheMaxSpacing\": 1.1", "cacheMaxSpacing: 1.1 is out of range"),
        ("unknown source", "@\"cacheSource\": \"path\"", "cacheSource: unknown name `path`"),
        ("unknown render key", "@\"spp\": 3", "spp: unknown key `spp`"),
    ] {
        l.top(name, &format!("\"render\": {{\n  {block}}}"), &format!("render.{expected}"));
    }
    l.top("render array", "@\"render\": []", "render: expected an object, found an array");
}

fn materials(l: &mut List) {
    let black = |more: &str| format!("{{\"name\": \"a\", \"type\": \"black\",\n{more}}}");
    for (name, more, expected) in [
        ("opacity above 1", "@\"opacity\": 1.5", "opacity: 1.5 is out of range"),
        ("opacity negative", "@\"opacity\": -0.5", "opacity: -0.5 is out of range"),
        ("opacity a string", "@\"opacity\": \"half\"", "opacity: invalid type: string"),
        ("opacity an array", "@\"opacity\": [1]", "opacity: invalid type: an array"),
        ("opacity of a lamp", "\"emission\": [1, 0, 0],\n@\"opacity\": 0.5", "opacity: a material that emits light"),
        ("emission of a material negative", "\"emission\": [0, 1,\n@-1]", "emission[2]: -1 is negative"),
        ("emission of a material a number", "@\"emission\": 1", "emission: invalid type: integer `1`"),
        ("luminance of a material of none", "@\"luminance\": 0", "luminance: 0 is not above 0"),
        (
            "two lights of a material",
            "\"emission\": [1, 1, 1],\n@\"luminance\": 5",
            "luminance: `emission` says the light",
        ),
        ("temperature of a material alone", "@\"temperature\": 3000", "temperature: is used with `luminance` only"),
        ("material too hot", "\"luminance\": 5,\n@\"temperature\": 15001", "temperature: 15001 is out of range"),
        ("emission of a material too large", "\"emission\": [\n@1e39, 1, 1]", "emission[0]: 1e39 is beyond single"),
    ] {
        l.material(name, &black(more), &format!("materials[1].{expected}"));
    }
    for (name, more, expected) in [
        ("mix of a veil", "\"opacity\": 0.5", "the material 'a' has an opacity"),
        ("mix of a lamp", "\"emission\": [1, 1, 1]", "the material 'a' has an emission"),
    ] {
        let mix = "{\"name\": \"b\", \"type\": \"mix\", \"materials\": [\"white\",\n@\"a\"]}";
        l.material(name, &format!("{},\n{mix}", black(more)), &format!("materials[2].materials[1]: {expected}"));
    }
    l.material("material not an object", "@\"white\"", "materials[1]: expected an object, found a string");
    l.material("material without type", "@{\"name\": \"a\", \"color\": [1, 1, 1]}", "materials[1]: missing key `type`");
    l.material(
        "unknown material type",
        "{\"name\": \"a\",\n@\"type\": \"difuse\"}",
        "materials[1].type: unknown type 'difuse', \
         expected one of diffuse, reflective, refractive, black, conductor",
    );
    l.material(
        "material without name",
        "@{\"type\": \"diffuse\", \"color\": [1, 1, 1]}",
        "materials[1]: missing key `name`",
    );
    l.material(
        "material name twice",
        "{\"type\": \"black\",\n@\"name\": \"white\"}",
        "materials[1].name: the material name 'white' is given twice",
    );
    l.material(
        "diffuse without color",
        "@{\"name\": \"a\", \"type\": \"diffuse\"}",
        "materials[1]: missing key `color`",
    );
    for (name, color, expected) in [
        ("albedo above 1", "[0,\n@1.1, 0]", "color[1]: a reflectance of 1.1 breaks conservation of energy"),
        ("albedo negative", "[\n@-0.5, 0, 0]", "color[0]: a reflectance of -0.5"),
        ("albedo of two", "@[1, 1]", "color: wrong length 2"),
        ("albedo a number", "@1", "color: invalid type: integer `1`"),
    ] {
        let text = format!("{{\"name\": \"a\", \"type\": \"diffuse\", \"color\":{color}}}");
        l.material(name, &text, &format!("materials[1].{expected}"));
    }
    let diffuse = |more: &str| format!("{{\"name\": \"a\", \"type\": \"diffuse\", \"color\": [1, 1, 1],\n{more}}}");
    for (name, more, expected) in [
        ("unknown brdf", "@\"brdf\": \"lambert\"", "materials[1].brdf: unknown name `lambert`"),
        (
            "roughness of lambertian",
            "@\"roughness\": 0.2",
            "materials[1].roughness: only a material with brdf 'oren-nayar'",
        ),
        (
            "sigma of oren-nayar",
            "\"brdf\": \"oren-nayar\",\n@\"sigmaDeg\": 9",
            "materials[1].sigmaDeg: only a material with brdf",
        ),
        (
            "roughness above 1",
            "\"brdf\": \"oren-nayar\",\n@\"roughness\": 2",
            "materials[1].roughness: 2 is out of range",
        ),
        (
            "sigma above 90",
            "\"brdf\": \"oren-nayar-qualitative\",\n@\"sigmaDeg\": 91",
            "materials[1].sigmaDeg: 91 is out of range",
        ),
        ("rate 0", "@\"reflectionRate\": 0", "materials[1].reflectionRate: 0 is not above 0"),
        ("rate above 1", "@\"reflectionRate\": 1.5", "materials[1].reflectionRate: 1.5 is out of range"),
        ("foreign key", "@\"refractionIndex\": 1.5", "materials[1].refractionIndex: unknown key"),
    ] {
        l.material(name, &diffuse(more), expected);
    }
    for (name, kind, more, expected) in [
        ("metal without keys", "@conductor", "", "materials[1]: expected one of: `metal`, `eta` with `k`"),
        (
            "unknown metal",
            "conductor",
            "@\"metal\": \"Xx\"",
            "materials[1].metal: unknown metal 'Xx', expected one of Ag",
        ),
        ("eta of 0", "conductor", "\"k\": [1, 1, 1],\n@\"eta\": [1, 0, 1]", "materials[1].eta[1]: 0 is not above 0"),
        ("k below 0", "conductor", "\"eta\": [1, 1, 1],\n@\"k\": [1, 1, -1]", "materials[1].k[2]: -1 is out of range"),
        (
            "metal twice",
            "@conductor",
            "\"metal\": \"Au\", \"reflectance\": [1, 1, 1]",
            "materials[1]: expected one of: `metal`",
        ),
        ("rough metal", "conductor", "\"metal\": \"Au\",\n@\"roughness\": 1.01", "materials[1].roughness: 1.01"),
        (
            "anisotropy 1",
            "conductor",
            "\"metal\": \"Au\",\n@\"anisotropy\": 1",
            "materials[1].anisotropy: 1 is out of range",
        ),
        (
            "grooves that scatter twice",
            "conductor",
            "\"metal\": \"Au\", \"masking\": \"v-cavity\",\n@\"multipleScattering\": true",
            "materials[1].multipleScattering: light that is reflected more than once",
        ),
        (
            "masking of 1982",
            "cook-torrance",
            "\"metal\": \"Au\",\n@\"masking\": \"smith\"",
            "materials[1].masking: the model says",
        ),
        ("no fibres", "sheen", "\"color\": [1, 1, 1],\n@\"roughness\": 0", "materials[1].roughness: 0 is not above 0"),
        (
            "sheet of more than 1",
            "diffuse-transmission",
            "\"color\": [0.6, 0, 0],\n@\"transmittance\": [0.6, 0, 0]",
            "materials[1].transmittance[0]: color and transmittance sum to 1.2",
        ),
        (
            "tint above 1",
            "thin-refractive",
            "\"refractionIndex\": 1.5,\n@\"transmittance\": [2, 0, 0]",
            "materials[1].transmittance[0]",
        ),
        (
            "coat of index 0",
            "coated-diffuse",
            "\"color\": [1, 1, 1],\n@\"refractionIndex\": 0",
            "materials[1].refractionIndex: 0",
        ),
        (
            "unknown parameter",
            "principled",
            "@\"baseColor\": [1, 1, 1]",
            "materials[1].baseColor: unknown key `baseColor`",
        ),
        ("metalness above 1", "principled", "@\"base_metalness\": 2", "materials[1].base_metalness: 2 is out of range"),
        ("mix of one", "mix", "@\"materials\": [\"white\"]", "materials[1].materials: wrong length 1"),
        (
            "mix of nobody",
            "mix",
            "\"materials\": [\"white\",\n@\"whit\"]",
            "materials[1].materials[1]: no material named 'whit'",
        ),
        (
            "mix of itself",
            "mix",
            "@\"materials\": [\"a\", \"white\"]",
            "materials[1].materials[0]: no material named 'a'",
        ),
        (
            "two sides of nobody",
            "two-sided",
            "\"front\": \"white\",\n@\"back\": \"x\"",
            "materials[1].back: no material named 'x'",
        ),
        ("negative depth", "principled", "@\"transmission_depth\": -1", "materials[1].transmission_depth: -1 is "),
        (
            "black depth",
            "principled",
            "\"transmission_weight\": 1, \"transmission_depth\": 2,\n@\"transmission_color\": [1, 0, 1]",
            "materials[1].transmission_color[1]: 0 is ",
        ),
        (
            "frosted absorption",
            "refractive",
            "\"refractionIndex\": 1.5, \"roughness\": 0.5,\n@\"absorption\": [1, -1, 1]",
            "materials[1].absorption[1]: -1 is negative",
        ),
    ] {
        let (before, kind) = kind.strip_prefix('@').map_or(("", kind), |kind| ("@", kind));
        let more = if more.is_empty() { String::new() } else { format!(",\n{more}") };
        l.material(name, &format!("{before}{{\"name\": \"a\", \"type\": \"{kind}\"{more}}}"), expected);
    }
    l.material(
        "oren-nayar without roughness",
        &format!("@{}", diffuse("\"brdf\": \"oren-nayar\"")),
        "materials[1]: missing key `roughness`",
    );
    l.material(
        "mirror above 1",
        "{\"name\": \"a\", \"type\": \"reflective\", \"color\": [0, 0,\n@2]}",
        "materials[1].color[2]: a reflectance of 2",
    );
    l.material(
        "glass without index",
        "@{\"name\": \"a\", \"type\": \"refractive\"}",
        "materials[1]: missing key `refractionIndex`",
    );
    l.material(
        "glass index 0",
        "{\"name\": \"a\", \"type\": \"refractive\",\n@\"refractionIndex\": 0}",
        "materials[1].refractionIndex: 0 is not above 0",
    );
    l.material(
        "exterior index negative",
        "{\"name\": \"a\", \"type\": \"refractive\", \"refractionIndex\": 1.5,\n@\"exteriorIndex\": -1}",
        "materials[1].exteriorIndex: -1 is not above 0",
    );
    l.material(
        "black with color",
        "{\"name\": \"a\", \"type\": \"black\",\n@\"color\": [0, 0, 0]}",
        "materials[1].color: unknown key",
    );
}

fn backplates(l: &mut List) {
    for (name, backplate, expected) in [
        ("backplate that is a name", "@\"photo\"", "backplate: expected"),
        ("backplate of nothing", "@{\"intensity\": 2}", "backplate: missing key `texture`, or `color`"),
        ("backplate negative", "{\n@\"color\": [0, -1, 0]}", "backplate.color[1]: -1 is negative"),
        ("backplate too bright", "{\n@\"color\": [1e30, 0, 0], \"intensity\": 1e30}", "backplate.color[0]: "),
        ("backplate intensity", "{\"color\": [1, 1, 1],\n@\"intensity\": -2}", "backplate.intensity: -2 is negative"),
        (
            "backplate in lux",
            "{\"color\": [1, 1, 1], \"intensity\": 5,\n@\"unit\": \"lx\"}",
            "backplate.unit: 'lx' is no unit of",
        ),
        ("backplate without a texture", "{\n@\"texture\": \"photo\"}", "backplate.texture: no texture named 'photo'"),
        ("backplate turned", "{\"color\": [1, 1, 1],\n@\"rotation\": 3}", "backplate.rotation: unknown key"),
    ] {
        l.top(name, &format!("\"backplate\": {backplate}"), expected);
    }
    for (key, expected) in [
        ("\"coordinates\": \"box\"", "'t' is projected on surfaces, expected the coordinates `uv`"),
        ("\"vertexColors\": true", "'t' is multiplied by the colours of vertices, which a backplate has not"),
    ] {
        let text = format!(
            "\"textures\": [{{\"name\": \"t\", \"type\": \"checker\", {key}}}], \"backplate\": {{\n@\"texture\": \"t\"}}"
        );
        l.top("backplate of such a texture", &text, &format!("backplate.texture: the texture {expected}"));
    }
}

fn lights(l: &mut List) {
    for (name, light, expected) in [
        (
            "light without type",
            "@{\"origin\": [0, 0, 0]}",
            "lights[0]: missing key `type`, expected one of point, area, distant, environment, sky, spot, web",
        ),
        ("unknown light", "{\n@\"type\": \"sun\"}", "lights[0].type: unknown type 'sun'"),
        ("light type null", "{\n\"origin\": 0, \"type\": null}", "lights[0]: missing key `type`"),
        (
            "sky without a formula",
            "@{\"type\": \"sky\", \"color\": [1, 1, 1]}",
            "lights[0]: missing key `cie`, or `perez`, or `turbidity`",
        ),
        (
            "sky of two formulas",
            "{\"type\": \"sky\", \"color\": [1, 1, 1], \"cie\": 5,\n@\"perez\": [0, -1, 0, 0, 0]}",
            "lights[0].perez: `cie` says the formula already",
        ),
        (
            "sky of a sixteenth type",
            "{\"type\": \"sky\", \"color\": [1, 1, 1],\n@\"cie\": 16}",
            "lights[0].cie: 16 is out of range, expected a whole number from 1 to 15",
        ),
        (
            "sky without its sun",
            "@{\"type\": \"sky\", \"color\": [1, 1, 1], \"cie\": 12}",
            "lights[0]: missing key `sun`, or `sunAt`",
        ),
        (
            "sky after sunset",
            "{\"type\": \"sky\", \"color\": [1, 1, 1], \"cie\": 12,\n@\"sun\": [1, -1, 0]}",
            "lights[0].sun: the sun is not above the horizon",
        ),
        (
            "sky of two suns",
            "{\"type\": \"sky\", \"color\": [1, 1, 1], \"cie\": 12, \"sun\": [0, 1, 0],\n@\"sunAt\": {\"latitude\": 48, \"longitude\": 11, \"time\": \"2026-06-21T10:30:00Z\"}}",
            "lights[0].sunAt: `sun` says the direction already",
        ),
        (
            "sky beyond the pole",
            "{\"type\": \"sky\", \"color\": [1, 1, 1], \"cie\": 12, \"sunAt\":\n{@\"latitude\": 98, \"longitude\": 11, \"time\": \"2026-06-21T10:30:00Z\"}}",
            "lights[0].sunAt.latitude: 98 is out of range, expected -90 to 90 degrees",
        ),
        (
            "sun of no time",
            "{\"type\": \"distant\", \"color\": [1, 1, 1], \"sunAt\": {\"latitude\": 48, \"longitude\": 11,\n@\"time\": \"noon\"}}",
            "lights[0].sunAt.time: 'noon' is no time in UTC",
        ),
        (
            "sun at night",
            "{\"type\": \"distant\", \"color\": [1, 1, 1], \"sunAt\": {\"latitude\": 48, \"longitude\": 11,\n@\"time\": \"2026-06-21T23:30:00Z\"}}",
            "lights[0].sunAt.time: the sun is ",
        ),
        (
            "north that is up",
            "{\"type\": \"distant\", \"color\": [1, 1, 1], \"sunAt\": {\"latitude\": 48, \"longitude\": 11, \"time\": \"2026-06-21T10:30:00Z\",\n@\"north\": [0, 1, 0]}}",
            "lights[0].sunAt.north: is parallel to `up`",
        ),
        (
            "formula beyond its range",
            "{\"type\": \"sky\", \"color\": [1, 1, 1], \"sun\": [0, 1, 0],\n@\"perez\": [0, 2, 0, 0, 0]}",
            "lights[0].perez[1]: 2 is out of range, expected a number in [-1000, 0]",
        ),
        (
            "formula without light",
            "@{\"type\": \"sky\", \"color\": [1, 1, 1], \"sun\": [0, 1, 0], \"perez\": [-1, 0, 0, 0, 0]}",
            "lights[0]: the formula gives no light",
        ),
        (
            "turbidity below pure air",
            "{\"type\": \"sky\", \"sun\": [0, 1, 0],\n@\"turbidity\": 0.5}",
            "lights[0].turbidity: 0.5 is out of range, expected a number in [1, 10]",
        ),
        (
            "turbidity beyond its table",
            "{\"type\": \"sky\", \"sun\": [0, 1, 0],\n@\"turbidity\": 10.5}",
            "lights[0].turbidity: 10.5 is out of range, expected a number in [1, 10]",
        ),
        (
            "turbidity of a type",
            "{\"type\": \"sky\", \"sun\": [0, 1, 0], \"turbidity\": 3,\n@\"cie\": 12}",
            "lights[0].cie: `turbidity` says the formula already",
        ),
        (
            "turbidity without a sun",
            "@{\"type\": \"sky\", \"turbidity\": 3}",
            "lights[0]: missing key `sun`, or `sunAt`",
        ),
        (
            "turbidity after sunset",
            "{\"type\": \"sky\", \"turbidity\": 3,\n@\"sun\": [1, -0.01, 0]}",
            "lights[0].sun: the sun is 0.573 degrees below the horizon",
        ),
        (
            "turbidity of a given zenith",
            "{\"type\": \"sky\", \"turbidity\": 3, \"sun\": [0, 1, 0],\n@\"scale\": \"zenith\"}",
            "lights[0].scale: with `turbidity` the sky has radiance of its own",
        ),
        (
            "turbidity of a given illuminance",
            "{\"type\": \"sky\", \"turbidity\": 3, \"sun\": [0, 1, 0], \"intensity\": 1,\n@\"unit\": \"lx\"}",
            "lights[0].unit: with `turbidity` the sky has radiance of its own",
        ),
        (
            "ground that makes light under a clear sky",
            "{\"type\": \"sky\", \"turbidity\": 3, \"sun\": [0, 1, 0], \"ground\":\n[0, @1.5, 0]}",
            "lights[0].ground[1]: a reflectance of 1.5",
        ),
        (
            "disk of no sky with a sun",
            "{\"type\": \"sky\", \"color\": [1, 1, 1], \"cie\": 5,\n@\"disk\": true}",
            "lights[0].disk: is used with `turbidity` only",
        ),
        (
            "diameter of no disk",
            "{\"type\": \"sky\", \"turbidity\": 3, \"sun\": [0, 1, 0], \"disk\": false,\n@\"angle\": 1}",
            "lights[0].angle: is the diameter of a disk that `disk` leaves out",
        ),
        (
            "disk wider than the sky",
            "{\"type\": \"sky\", \"turbidity\": 3, \"sun\": [0, 1, 0],\n@\"angle\": 200}",
            "lights[0].angle: 200 is out of range, expected 0 to 180 degrees",
        ),
        (
            "clear sky beyond single precision",
            "{\"type\": \"sky\", \"turbidity\": 3, \"sun\": [0, 1, 0],\n@\"color\": [1e37, 1, 1]}",
            "lights[0].color: [1e37, 1.0, 1.0] times the sky is beyond single precision",
        ),
        (
            "sky too bright beside the sun",
            "@{\"type\": \"sky\", \"color\": [1e38, 1, 1], \"sun\": [4, 1, 0], \"cie\": 13}",
            "lights[0]: the formula gives no light, or light beyond single precision",
        ),
        (
            "ground that glows",
            "{\"type\": \"sky\", \"color\": [1, 1, 1], \"cie\": 1,\n@\"ground\": [2, 0, 0]}",
            "lights[0].ground[0]: a reflectance of 2 breaks conservation of energy",
        ),
        (
            "distant light from nowhere",
            "@{\"type\": \"distant\", \"color\": [1, 1, 1]}",
            "lights[0]: missing key `sun`, or `sunAt`",
        ),
        (
            "distant light without a way",
            "{\"type\": \"distant\", \"color\": [1, 1, 1],\n@\"sun\": [0, 0, 0]}",
            "lights[0].sun: [0.0, 0.0, 0.0] has no direction",
        ),
        (
            "distant light too wide",
            "{\"type\": \"distant\", \"color\": [1, 1, 1], \"sun\": [0, 1, 0],\n@\"angle\": 181}",
            "lights[0].angle: 181 is out of range, expected 0 to 180 degrees",
        ),
        (
            "distant light too narrow for its light",
            "{\"type\": \"distant\", \"color\": [1, 1, 1], \"sun\": [0, 1, 0],\n@\"angle\": 1e-30}",
            "lights[0].angle: 0.000000000000000000000000000001 is too small",
        ),
        (
            "dark distant light",
            "{\"type\": \"distant\", \"sun\": [0, 1, 0],\n@\"color\": [1, -1, 1]}",
            "lights[0].color[1]: -1 is negative",
        ),
        (
            "up of a distant light alone",
            "{\"type\": \"distant\", \"color\": [1, 1, 1], \"sun\": [0, 1, 0],\n@\"up\": [0, 0, 1]}",
            "lights[0].up: is used with `sunAt` only",
        ),
        (
            "spot without direction",
            "@{\"type\": \"spot\", \"origin\": [0, 0, 0], \"color\": [1, 1, 1]}",
            "lights[0]: missing key `direction`",
        ),
        (
            "spot without a way",
            "{\"type\": \"spot\", \"origin\": [0, 0, 0], \"color\": [1, 1, 1],\n@\"direction\": [0, 0, 0]}",
            "lights[0].direction: [0.0, 0.0, 0.0] has no direction",
        ),
        (
            "spot too narrow",
            "{\"type\": \"spot\", \"origin\": [0, 0, 0], \"color\": [1, 1, 1], \"direction\": [0, 1, 0],\n\
             @\"outerConeAngle\": 0}",
            "lights[0].outerConeAngle: 0 degrees are out of range, expected an angle from the axis in [0.01, 180]",
        ),
        (
            "spot inside out",
            "{\"type\": \"spot\", \"origin\": [0, 0, 0], \"color\": [1, 1, 1], \"direction\": [0, 1, 0],\n\
             @\"innerConeAngle\": 46}",
            "lights[0].innerConeAngle: 46 degrees are out of range, expected an angle from the axis in [0, 45]",
        ),
        ("point without origin", "@{\"type\": \"point\", \"color\": [1, 1, 1]}", "lights[0]: missing key `origin`"),
        ("point without color", "@{\"type\": \"point\", \"origin\": [1, 1, 1]}", "lights[0]: missing key `color`"),
        (
            "light of negative color",
            "{\"type\": \"point\", \"origin\": [1, 1, 1], \"color\": [1,\n@-1, 1]}",
            "lights[0].color[1]: -1 is negative",
        ),
        (
            "light of negative intensity",
            "{\"type\": \"point\", \"origin\": [1, 1, 1], \"color\": [1, 1, 1],\n@\"intensity\": -1}",
            "lights[0].intensity: -1 is negative",
        ),
        (
            "light beyond single precision",
            "{\"type\": \"point\", \"origin\": [1, 1, 1], \"color\": [\n@1e30, 1, 1], \"intensity\": 1e10}",
            "lights[0].color[0]: 1e40 is beyond single precision",
        ),
        (
            "lamp of a unit that it has not",
            "{\"type\": \"point\", \"origin\": [1, 1, 1], \"intensity\": 3,\n@\"unit\": \"lx\"}",
            "lights[0].unit: 'lx' is no unit of this light, expected one of W, cd, lm",
        ),
        (
            "lamp of an unknown unit",
            "{\"type\": \"point\", \"origin\": [1, 1, 1], \"intensity\": 3,\n@\"unit\": \"lumen\"}",
            "lights[0].unit: unknown name `lumen`",
        ),
        (
            "lamp of no lumens",
            "{\"type\": \"point\", \"origin\": [1, 1, 1], \"unit\": \"lm\",\n@\"intensity\": 0}",
            "lights[0].intensity: 0 is not above 0",
        ),
        (
            "lamp of negative candela",
            "{\"type\": \"spot\", \"origin\": [1, 1, 1], \"direction\": [1, 1, 1], \"unit\": \"cd\",\n@\"intensity\": -4}",
            "lights[0].intensity: -4 is not above 0",
        ),
        (
            "lamp of a unit alone",
            "@{\"type\": \"point\", \"origin\": [1, 1, 1], \"unit\": \"lm\"}",
            "lights[0]: missing key `intensity`, in lm",
        ),
        (
            "lamp of two colours",
            "{\"type\": \"point\", \"origin\": [1, 1, 1], \"color\": [1, 1, 1],\n@\"temperature\": 2700}",
            "lights[0].temperature: `color` says the colour already, expected one of both",
        ),
        (
            "lamp too cold",
            "{\"type\": \"distant\", \"sun\": [1, 1, 1],\n@\"temperature\": 999}",
            "lights[0].temperature: 999 is out of range, expected a temperature from 1000 to 15000 kelvin",
        ),
        (
            "black lamp of so many lux",
            "{\"type\": \"distant\", \"sun\": [1, 1, 1], \"unit\": \"lx\", \"intensity\": 3,\n@\"color\": [0, 0, 0]}",
            "lights[0].color: [0.0, 0.0, 0.0] is black",
        ),
        (
            "sky of a unit that its scale is not of",
            "{\"type\": \"sky\", \"cie\": 1, \"scale\": \"zenith\", \"intensity\": 3,\n@\"unit\": \"lx\"}",
            "lights[0].unit: 'lx' is no unit of this light, expected one of W, cd/m2",
        ),
        (
            "area without vertex",
            "@{\"type\": \"area\", \"vertex-1\": [0, 0, 0], \"vertex-2\": [1, 0, 0], \"color\": [1, 1, 1]}",
            "lights[0]: missing key `vertex-3`",
        ),
        (
            "area light with origin",
            "{\"type\": \"area\",\n@\"origin\": [0, 0, 0]}",
            "lights[0].origin: unknown key `origin`",
        ),
    ] {
        let marked = if light.contains('@') { light.to_owned() } else { format!("@{light}") };
        l.top(name, &format!("\"lights\": [\n{marked}]"), expected);
    }
}

fn surfaces(l: &mut List) {
    l.surface("surface not an object", "@[]", "surfaces[1]: expected an object, found an array");
    l.surface(
        "surface without geometry",
        "@{\"material\": \"white\"}",
        "surfaces[1]: missing key `geometry`, expected one of sphere",
    );
    l.surface(
        "unknown geometry",
        "{\"material\": \"white\",\n@\"geometry\": \"torus\"}",
        "surfaces[1].geometry: unknown geometry 'torus'",
    );
    l.surface(
        "mistyped geometry",
        "{\n@\"geometry\": \"spere\"}",
        "surfaces[1].geometry: unknown geometry 'spere', expected one of sphere, \
         triangle, quad, mesh, quadric, cylinder, cone, disk, ellipsoid, paraboloid, group; did you mean 'sphere'?",
    );
    l.surface(
        "geometry twice",
        "{\"geometry\": \"sphere\",\n@\"geometry\": \"sphere\"}",
        "surfaces[1].geometry: key given twice",
    );
    l.surface(
        "geometry number",
        "{\n@\"geometry\": 3}",
        "surfaces[1].geometry: invalid type: integer `3`, expected a string",
    );
    l.surface(
        "sphere without origin",
        "@{\"geometry\": \"sphere\", \"radius\": 1, \"material\": \"white\"}",
        "surfaces[1]: missing key `origin`",
    );
    l.surface(
        "sphere without material",
        "@{\"geometry\": \"sphere\", \"radius\": 1, \"origin\": [0, 0, 0]}",
        "surfaces[1]: missing key `material`",
    );
    l.surface(
        "unknown material",
        "{\"geometry\": \"sphere\", \"radius\": 1, \"origin\": [0, 0, 0],\n@\"material\": \"whit\"}",
        "surfaces[1].material: no material named 'whit'; did you mean 'white'?",
    );
    for (name, radius, expected) in [
        ("radius 0", "0", "radius: 0 is not above 0"),
        ("radius negative", "-1", "radius: -1 is not above 0"),
        ("radius tiny", "1e-60", "radius: 0.000"),
        ("radius beyond single precision", "1e60", "radius: 1e60 is beyond single precision"),
        ("radius null", "null", "radius: invalid type: null, expected a number"),
        ("radius true", "true", "radius: invalid type: boolean `true`, expected a number"),
    ] {
        let text = format!(
            "{{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"material\": \"white\",\n@\"radius\": {radius}}}"
        );
        l.surface(name, &text, &format!("surfaces[1].{expected}"));
    }
    l.sphere("emission negative", "\"emission\": [1, 1,\n@-1]", "surfaces[1].emission[2]: -1 is negative");
    l.sphere("luminance negative", "@\"luminance\": -2", "surfaces[1].luminance: -2 is not above 0");
    l.sphere(
        "luminance and emission",
        "\"emission\": [1, 1, 1],\n@\"luminance\": 2",
        "surfaces[1].luminance: `emission` says the light already",
    );
    l.sphere("luminance beyond single precision", "@\"luminance\": 1e40", "surfaces[1].luminance: ");
    l.sphere("emission a number", "@\"emission\": 1", "surfaces[1].emission: invalid type: integer `1`");
    l.sphere("unknown surface key", "@\"colour\": 1", "surfaces[1].colour: unknown key `colour`");
    l.surface(
        "sphere out of range",
        "@{\"geometry\": \"sphere\", \"origin\": [3e38, 0, 0], \"radius\": 3e38, \"material\": \"white\"}",
        "surfaces[1]: the surface reaches to 6e38, beyond single precision",
    );
    l.surface(
        "triangle without vertex",
        "@{\"geometry\": \"triangle\", \"vertex-1\": [0, 0, 0], \"vertex-2\": [1, 0, 0], \"material\": \"white\"}",
        "surfaces[1]: missing key `vertex-3`",
    );
    l.surface(
        "triangle with bad vertex",
        "{\"geometry\": \"triangle\", \"vertex-1\": [0, 0, 0], \"vertex-2\": [1,\n@[], 0], \"material\": \"white\"}",
        "surfaces[1].vertex-2[1]: invalid type: an array, expected a number",
    );
    let bent = "surfaces[1].vertex-4: the quad is not flat: vertex-4 is off the plane of the others by";
    l.surface(
        "bent quad",
        "{\"geometry\": \"quad\", \"material\": \"white\", \"vertex-1\": [0, 0, 0], \"vertex-2\": [1, 0, 0],\n\
         \"vertex-3\": [1, 1, 0],\n@\"vertex-4\": [0, 1, 0.1]}",
        bent,
    );
    l.surface(
        "tiny bent quad",
        "{\"geometry\": \"quad\", \"material\": \"white\", \"vertex-1\": [0, 0, 0], \"vertex-2\": [1e-15, 0, 0],\n\
         \"vertex-3\": [1e-15, 1e-15, 0],\n@\"vertex-4\": [0, 1e-15, 1e-18]}",
        bent,
    );
    l.quad("quad of a point", ["[1, 1, 1]"; 4], "surfaces[1]: the quad has no area");
    l.quad(
        "quad on a line",
        ["[0, 0, 0]", "[1, 0, 0]", "[2, 0, 0]", "[0, 1, 0]"],
        "surfaces[1]: the quad's first three vertices lie on a line",
    );
    l.surface(
        "crossed quad",
        "{\"geometry\": \"quad\", \"material\": \"white\", \"vertex-1\": [0, 0, 0],\n\"vertex-2\": [1, 0, 0],\n\
         @\"vertex-3\": [0, 1, 0],\n\"vertex-4\": [1, 1, 0]}",
        "surfaces[1].vertex-3: the quad is not convex, or its vertices are not in order",
    );
    l.surface(
        "dented quad",
        "{\"geometry\": \"quad\", \"material\": \"white\", \"vertex-1\": [0, 0, 0],\n\"vertex-2\": [2, 0, 0],\n\
         \"vertex-3\": [0, 2, 0],\n@\"vertex-4\": [0.5, 0.5, 0]}",
        "surfaces[1].vertex-4: the quad is not convex",
    );
}

fn placements(l: &mut List) {
    for (name, transform, expected) in [
        ("transform number", "@\"transform\": 1", ": expected an object or an array of objects, found a number"),
        ("transform of numbers", "\"transform\": [\n@1]", "[0]: expected an object, found a number"),
        ("nested transforms", "\"transform\": [{},\n@[]]", "[1]: expected an object, found an array"),
        ("unknown transform key", "\"transform\": {\n@\"move\": [0, 0, 0]}", ".move: unknown key `move`"),
        ("matrix too short", "\"transform\": {\n@\"matrix\": [1, 0, 0, 0]}", ".matrix: wrong length 4"),
        (
            "matrix of rows",
            "\"transform\": {\"matrix\": [\n@[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}",
            ".matrix[0]: invalid type: an array, expected a number",
        ),
        (
            "matrix by columns",
            "\"transform\": {\n@\"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]}",
            ".matrix: the last row is [4.0, 5.0, 6.0, 1.0], expected [0, 0, 0, 1]",
        ),
        (
            "matrix and translate",
            "\"transform\": {\"translate\": [0, 0, 0],\n@\"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}",
            ".matrix: `matrix` stands alone",
        ),
        (
            "singular matrix",
            "@\"transform\": {\"matrix\": [1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}",
            ": the transform cannot be undone",
        ),
        (
            "zero matrix",
            "@\"transform\": {\"matrix\": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]}",
            ": the transform cannot",
        ),
        ("scale 0", "\"transform\": {\n@\"scale\": 0}", ".scale: a scale of 0 flattens the object"),
        ("scale with 0", "\"transform\": {\n@\"scale\": [1, 0, 1]}", ".scale: a scale of 0 flattens the object"),
        (
            "scale string",
            "\"transform\": {\n@\"scale\": \"2\"}",
            ".scale: invalid type: string \"2\", expected a number or an array",
        ),
        ("scale of two", "\"transform\": {\n@\"scale\": [1, 2]}", ".scale: wrong length 2"),
        ("rotate a number", "\"transform\": {\n@\"rotate\": 90}", ".rotate: invalid type"),
        (
            "scales that overflow",
            "@\"transform\": [{\"scale\": 1e38}, {\"scale\": 1e38}, {\"scale\": 1e38}, {\"scale\": 1e38}, \
             {\"scale\": 1e38}, \
             {\"scale\": 1e38}, {\"scale\": 1e38}, {\"scale\": 1e38}, {\"scale\": 1e38}]",
            ": the transform overflows",
        ),
    ] {
        l.sphere(name, transform, &format!("surfaces[1].transform{expected}"));
    }
    l.surface(
        "moved out of range",
        "@{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1e20, \"material\": \"white\", \
         \"transform\": {\"scale\": 1e20}}",
        "surfaces[1]: the surface reaches to 1e40",
    );
    l.surface(
        "shrunk out of range",
        "@{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1e-30, \"material\": \"white\", \
         \"transform\": {\"scale\": 1e-30}}",
        "surfaces[1]: the surface is",
    );
}

fn meshes(l: &mut List) {
    let mesh = |more: &str| format!("@{{\"geometry\": \"mesh\", \"material\": \"white\"{more}}}");
    let points = ",\n \"positions\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
    l.surface("mesh without triangles", &mesh(""), "surfaces[1]: the mesh has no triangles");
    l.surface("mesh twice", &mesh(", \"file\": \"a.obj\", \"mesh\": \"a\""), "surfaces[1]: the mesh is given twice");
    l.surface(
        "mesh in place and by file",
        &mesh(", \"file\": \"a.obj\", \"positions\": []"),
        "surfaces[1]: the mesh is given twice",
    );
    l.surface("mesh with points only", &mesh(points), "surfaces[1]: missing key `triangles`");
    l.surface("mesh without points", &mesh(", \"triangles\": [[0, 1, 2]]"), "surfaces[1]: missing key `positions`");
    for (name, more, expected) in [
        ("empty mesh", ",\n@\"triangles\": []", "triangles: the mesh is empty"),
        (
            "index out of range",
            ", \"triangles\": [[0, 1, 2], [0, 1,\n@3]]",
            "triangles[1][2]: there is no vertex 3, expected an index below 3",
        ),
        ("index negative", ", \"triangles\": [[0, 1,\n@-1]]", "triangles[0][2]: invalid value: integer `-1`"),
        ("index broken", ", \"triangles\": [[0, 1,\n@1.5]]", "triangles[0][2]: invalid type: floating point `1.5`"),
        (
            "index beyond 32 bits",
            ", \"triangles\": [[0, 1,\n@4294967296]]",
            "triangles[0][2]: invalid value: integer `4294967296`",
        ),
        ("triangle of four", ", \"triangles\": [\n@[0, 1, 2, 0]]", "triangles[0]: too many elements"),
        (
            "normals missing",
            ", \"triangles\": [[0, 1, 2]],\n@\"normals\": [[0, 0, 1]]",
            "normals: 1 normals for 3 positions",
        ),
        ("uvs missing", ", \"triangles\": [[0, 1, 2]],\n@\"uvs\": [[0, 0]]", "uvs: 1 uvs for 3 positions"),
        (
            "normal out of range",
            ", \"triangles\": [[0, 1, 2]], \"normals\": [[0, 0, 1], [0, 0,\n@1e50], [0, 0, 1]]",
            "normals[1][2]: 1e50 is beyond single precision",
        ),
        ("unknown shading", ", \"triangles\": [[0, 1, 2]],\n@\"shading\": \"phong\"", "shading: unknown name `phong`"),
        ("mesh scale 0", ", \"triangles\": [[0, 1, 2]],\n@\"scale\": 0", "scale: a scale of 0"),
    ] {
        let text = mesh(&format!("{points}{more}")).replacen('@', "", 1);
        l.surface(name, &text, &format!("surfaces[1].{expected}"));
    }
    l.surface(
        "position out of range",
        "{\"geometry\": \"mesh\", \"material\": \"white\", \"triangles\": [[0, 0, 0]], \"positions\": [[0,\n@4e38, \
         0]]}",
        "surfaces[1].positions[0][1]: 4e38 is beyond single precision",
    );
    l.surface(
        "unknown mesh",
        "{\"geometry\": \"mesh\", \"material\": \"white\",\n@\"mesh\": \"a\"}",
        "surfaces[1].mesh: no mesh named 'a'",
    );
    l.surface(
        "missing mesh file",
        "@{\"geometry\": \"mesh\", \"material\": \"white\", \"file\": \"\"}",
        "surfaces[1].file: the file name is empty",
    );
    l.top(
        "shared mesh without name",
        "\"meshes\": [\n@{\"positions\": [], \"triangles\": []}]",
        "meshes[0]: missing key `name`",
    );
    l.top(
        "shared mesh without triangles",
        "\"meshes\": [\n@{\"name\": \"a\"}]",
        "meshes[0]: the mesh has no triangles",
    );
    let shared = "{\"name\": \"a\", \"positions\": [[0, 0, 0]], \"triangles\": [[0, 0, 0]]}";
    l.top(
        "mesh name twice",
        &format!("\"meshes\": [{shared},\n{}]", shared.replace("\"name\"", "\n@\"name\"")),
        "meshes[1].name: the mesh name 'a' is given twice",
    );
    groups(l);
}

fn groups(l: &mut List) {
    let ball = "{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1, \"material\": \"white\"}";
    let group = |more: &str| format!("\"groups\": [{{\"name\": \"a\", {more}}}]");
    let one = group(&format!("\"surfaces\": [{ball}]"));
    let placed = |more: &str| format!("{one},\n\"surfaces\": [{{\"geometry\": \"group\", {more}}}]");
    let moving = ball.replace('}', ",\n\"motion\": [{\"time\": 0}, {\"time\": 1, \"translate\": [1, 0, 0]}]}");
    for (name, text, expected) in [
        ("group without name", format!("\"groups\": [\n@{{\"surfaces\": [{ball}]}}]"), "groups[0]: missing key `name`"),
        (
            "group with an empty name",
            format!("\"groups\": [{{\"surfaces\": [{ball}],\n@\"name\": \"\"}}]"),
            "groups[0].name: the name is empty",
        ),
        ("group without surfaces", group("\n@\"surfaces\": []"), "groups[0].surfaces: the group is empty"),
        (
            "group with an unknown key",
            group(&format!("\"surfaces\": [{ball}],\n@\"x\": 1")),
            "groups[0].x: unknown key `x`",
        ),
        (
            "surface of a group that is wrong",
            group(&format!("\"surfaces\": [{}]", ball.replace("\"radius\": 1", "\n@\"radius\": -1"))),
            "groups[0].surfaces[0].radius: -1 is not above 0",
        ),
        (
            "surface of a group that moves",
            group(&format!("\"surfaces\": [{}]", moving.replace("\"motion\"", "@\"motion\""))),
            "groups[0].surfaces[0].motion: the surfaces of a group rest",
        ),
        (
            "group of itself",
            group("\"surfaces\": [{\"geometry\": \"group\",\n@\"group\": \"a\"}]"),
            "groups[0].surfaces[0].group: no group named 'a'",
        ),
        ("unknown group", placed("\n@\"group\": \"b\""), "surfaces[0].group: no group named 'b'"),
        (
            "placement without group",
            format!("{one},\n\"surfaces\": [\n@{{\"geometry\": \"group\"}}]"),
            "surfaces[0]: missing key `group`",
        ),
        (
            "placement with a material",
            placed("\"group\": \"a\",\n@\"material\": \"white\""),
            "surfaces[0].material: unknown key `material`",
        ),
        (
            "placement that is flat",
            placed("\"group\": \"a\",\n\"transform\": {\n@\"scale\": [1, 0, 1]}"),
            "surfaces[0].transform.scale: a scale of 0 flattens the object",
        ),
        (
            "placement too far away",
            placed("\"group\": \"a\",\n\"transform\": {\"scale\": 1e37, \"translate\": [3.4e38, 0, 0]}")
                .replace("\"surfaces\": [{\"geometry\": \"group\"", "\"surfaces\": [\n@{\"geometry\": \"group\""),
            "surfaces[0]",
        ),
    ] {
        l.top(name, &text, expected);
    }
    l.top(
        "group name twice",
        &format!(
            "\"groups\": [{{\"name\": \"a\", \"surfaces\": [{ball}]}}, {{\"surfaces\": [{ball}],\n@\"name\": \"a\"}}]"
        ),
        "groups[1].name: the group name 'a' is given twice",
    );
}

fn quadrics(l: &mut List) {
    let quadric = |more: &str| format!("{{\"geometry\": \"quadric\", \"material\": \"white\",\n{more}}}");
    let ball = "\"coefficients\": [1, 1, 1, 0, 0, 0, 0, 0, 0, -1]";
    for (name, more, expected) in [
        ("nine coefficients", "@\"coefficients\": [1, 1, 1, 0, 0, 0, 0, 0, 0]", ".coefficients: wrong length 9"),
        (
            "no surface",
            "@\"coefficients\": [0, 0, 0, 0, 0, 0, 0, 0, 0, 1]",
            ".coefficients: all coefficients but the last are 0",
        ),
        ("coefficient out of range", "\"coefficients\": [1, 1, 1, 0, 0, 0, 0, 0, 0,\n@1e40]", ".coefficients[9]: 1e40"),
        (
            "clip array",
            &format!("{ball},\n@\"clip\": [[0, 0, 0], [1, 1, 1]]"),
            ".clip: expected an object, found an array",
        ),
        ("clip without max", &format!("{ball},\n@\"clip\": {{\"min\": [0, 0, 0]}}"), ".clip: missing key `max`"),
        (
            "clip empty",
            &format!("{ball},\n@\"clip\": {{\"min\": [1, 0, 0], \"max\": [0, 1, 1]}}"),
            ".clip: the box is empty",
        ),
        (
            "quadric emits",
            &format!("{ball},\n@\"emission\": [1, 1, 1]"),
            ".emission: of the quadrics, only cylinders can emit light",
        ),
    ] {
        l.surface(name, &quadric(more), &format!("surfaces[1]{expected}"));
    }
    l.surface(
        "endless quadric",
        &format!("@{}", quadric("\"coefficients\": [1, 1, 0, 0, 0, 0, 0, 0, 0, -1]")),
        "surfaces[1]: missing key `clip`",
    );
    l.surface(
        "quadric without points",
        &format!("@{}", quadric("\"coefficients\": [1, 1, 1, 0, 0, 0, 0, 0, 0, 1]")),
        "surfaces[1]: missing key `clip`",
    );
    let named = |kind: &str, keys: &str| format!("@{{\"geometry\": \"{kind}\", \"material\": \"white\", {keys}}}");
    for (name, kind, keys, expected) in [
        (
            "cylinder without axis",
            "cylinder",
            "\"base\": [0, 0, 0], \"radius\": 1, \"height\": 1",
            ": missing key `axis`",
        ),
        (
            "cylinder with zero axis",
            "cylinder",
            "\"base\": [0, 0, 0], \"axis\": [0, 0, 0], \"radius\": 1, \"height\": 1",
            ".axis: [0.0, 0.0, 0.0] has no direction",
        ),
        (
            "cylinder radius",
            "cylinder",
            "\"base\": [0, 0, 0], \"axis\": [0, 0, 1], \"radius\": 0, \"height\": 1",
            ".radius: 0 is not above 0",
        ),
        (
            "cone height",
            "cone",
            "\"base\": [0, 0, 0], \"axis\": [0, 0, 1], \"radius\": 1, \"height\": -1",
            ".height: -1 is not above 0",
        ),
        (
            "disk normal",
            "disk",
            "\"origin\": [0, 0, 0], \"normal\": [0, 0, 0], \"radius\": 1",
            ".normal: [0.0, 0.0, 0.0] has no direction",
        ),
        (
            "cone emits",
            "cone",
            "\"base\": [0, 0, 0], \"axis\": [0, 0, 1], \"radius\": 1, \"height\": 1, \"emission\": [1, 0, 0]",
            ".emission: of the quadrics, only cylinders can emit",
        ),
        ("ellipsoid radius", "ellipsoid", "\"origin\": [0, 0, 0], \"radii\": [1, 0, 1]", ".radii[1]: 0 is not above 0"),
        (
            "paraboloid without apex",
            "paraboloid",
            "\"axis\": [0, 0, 1], \"radius\": 1, \"height\": 1",
            ": missing key `apex`",
        ),
    ] {
        l.surface(name, &named(kind, keys), &format!("surfaces[1]{expected}"));
    }
}

fn reports(l: &mut List) {
    l.text("mcrt without camera", "\n@{\"surfaces\": []}", "missing key `camera`");
    l.text("mcrt camera upside down", "{\"camera\": {\n@\"up\": [0, 0, 1]}}", "camera.up: the vector is parallel");
    l.text("mcrt camera string", "{\n@\"camera\": \"front\"}", "camera: expected an object, found a string");
    for (name, more, expected) in [
        (
            "mcrt light without intensity",
            "\"lights\": [\n@{\"type\": \"point\", \"origin\": [0, 0, 0], \"color\": [1, 1, 1]}]",
            "lights[0]: missing key `intensity`",
        ),
        (
            "mcrt light type",
            "\"lights\": [{\n@\"type\": \"spot\"}]",
            "lights[0].type: unknown type 'spot', expected one of point, area",
        ),
        (
            "mcrt geometry",
            "\"surfaces\": [{\n@\"geometry\": \"quad\"}]",
            "surfaces[0].geometry: unknown geometry 'quad', expected one of sphere, triangle, \
             mesh (a file without \"etendue\": 1",
        ),
        (
            "mcrt material name",
            "\"surfaces\": [{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \
             \"radius\": 1,\n@\"material\": \"wite\"}]",
            "surfaces[0].material: no material named 'wite'; did you mean 'white'?",
        ),
        (
            "mcrt radius",
            "\"surfaces\": [{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \
             \"material\": \"white\",\n@\"radius\": -1}]",
            "surfaces[0].radius: -1 is not above 0",
        ),
        (
            "mcrt mesh without origin",
            "\"surfaces\": [\n@{\"geometry\": \"mesh\", \"file\": \"a.obj\", \"material\": \"white\"}]",
            "surfaces[0]: missing key `origin`",
        ),
        (
            "mcrt mesh scale",
            "\"surfaces\": [{\"geometry\": \"mesh\", \"file\": \"a.obj\", \"material\": \"white\", \"origin\": [0, \
             0, 0],\n@\"scale\": [1, 1, 1]}]",
            "surfaces[0].scale: invalid type: an array, expected a number",
        ),
    ] {
        l.mcrt(name, more, expected);
    }
    let material = |more: &str| format!("{{\"camera\": {{}}, \"materials\": [\n {{\"name\": \"a\",\n {more}}}]}}");
    for (name, more, expected) in [
        ("mcrt material type", "@\"type\": \"metal\"", "materials[0].type: unknown type 'metal'"),
        (
            "mcrt brdf",
            "\"type\": \"diffuse\", \"color\": [1, 1, 1],\n@\"brdf\": \"phong\"",
            "materials[0].brdf: unknown brdf 'phong'",
        ),
        (
            "mcrt albedo",
            "\"type\": \"diffuse\",\n\"color\": [1,\n@1.01, 1], \"brdf\": \"lambertian\"",
            "materials[0].color[1]: a reflectance of 1.01 breaks",
        ),
        (
            "mcrt mirror",
            "\"type\": \"reflective\",\n\"color\": [\n@9, 1, 1]",
            "materials[0].color[0]: a reflectance of 9 breaks",
        ),
        (
            "mcrt glass",
            "\"type\": \"refractive\", \"color\": [1, 1, 1],\n@\"refractionIndex\": 0",
            "materials[0].refractionIndex: 0 is not above 0",
        ),
        (
            "mcrt roughness",
            "\"type\": \"diffuse\", \"color\": [1, 1, 1], \"brdf\": \"oren-nayar\",\n@\"roughness\": 2",
            "materials[0].roughness: 2 is out of range",
        ),
    ] {
        l.text(name, &material(more), expected);
    }
}
