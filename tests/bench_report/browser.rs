//! Chromium without a window, through its DevTools protocol over a pair of pipes: JSON messages that end in NUL.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use base64::Engine;
use serde_json::{Value, json};
use tempfile::TempDir;

/// Longer than anything takes, even beside other work.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page; ends when it is dropped.
pub struct Browser {
    child: Child,
    orders: File,
    messages: Receiver<Value>,
    session: String,
    number: u64,
    /// Events since the page was opened.
    events: Vec<Value>,
    _folder: TempDir,
}

impl Browser {
    /// Starts it; `None`, loudly, where there is none.
    pub fn start() -> Option<Self> {
        let wanted = std::env::var("CHROMIUM").ok();
        let names = wanted
            .as_deref()
            .map_or(vec!["chromium-headless-shell", "chromium", "chromium-browser"], |name| vec![name]);
        let is_there =
            |name: &&&str| Command::new(name).arg("--version").output().is_ok_and(|run| run.status.success());
        let Some(name) = names.iter().find(is_there) else {
            eprintln!(
                "\n*** SKIPPED: Chromium is missing, so NOTHING ABOUT THE REPORT'S PAGE WAS TESTED. ***\n\
                 *** Install it with scripts/setup.sh test, or name it in CHROMIUM. ***\n"
            );
            return None;
        };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (orders, answers) = (folder.path().join("orders"), folder.path().join("answers"));
        let made = Command::new("mkfifo").args([&orders, &answers]).status().expect("mkfifo");
        assert!(made.success(), "no pipes");
        // The protocol is spoken on the descriptors 3 and 4, which a shell can open.
        let mut command = Command::new("sh");
        command.args(["-c", "exec \"$@\" 3<\"$ORDERS\" 4>\"$ANSWERS\"", "sh", name]);
        command.env("ORDERS", &orders).env("ANSWERS", &answers).env("HOME", folder.path());
        command.args(["--headless", "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu", "--disable-quic"]);
        command.args([
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
        ]);
        command.arg(format!("--user-data-dir={}", folder.path().join("profile").display())).arg("about:blank");
        let child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("a shell");
        let orders = OpenOptions::new().write(true).open(orders).expect("a pipe to the browser");
        let answers = File::open(answers).expect("a pipe from the browser");
        let (sender, messages) = channel();
        thread::spawn(move || {
            for message in BufReader::new(answers).split(0).map_while(Result::ok) {
                let message = serde_json::from_slice(&message).expect("JSON from the browser");
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let (session, events) = (String::new(), Vec::new());
        let mut browser = Self { child, orders, messages, session, number: 0, events, _folder: folder };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", json!({"targetId": target, "flatten": true}));
        browser.session = attached["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        // A page that is not looked at gives nothing the focus.
        browser.call("Emulation.setFocusEmulationEnabled", json!({"enabled": true}));
        Some(browser)
    }

    /// Opens a file from the disk in a window of this size, and waits until it is loaded.
    pub fn open(&mut self, file: &Path, width: u32, height: u32) {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", size);
        self.events.clear();
        let answer = self.call("Page.navigate", json!({"url": format!("file://{}", file.display())}));
        assert!(answer.get("errorText").is_none(), "{answer}");
        self.wait("document.readyState === 'complete' && document.querySelector('main section') !== null");
    }

    /// Prefers dark pages, or light ones.
    pub fn prefer(&mut self, scheme: &str) {
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.call("Emulation.setEmulatedMedia", json!({"features": features}));
    }

    /// The value of an expression, a promise's when it is kept.
    pub fn value(&mut self, expression: &str) -> Value {
        let what = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", what);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn wait(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(expression) != true {
            assert!(start.elapsed() < PATIENCE, "never true: {expression}; {:?}", self.events);
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses a key and lets it go.
    pub fn key(&mut self, key: &str, code: &str) {
        for kind in ["keyDown", "keyUp"] {
            let text = if kind == "keyDown" { key } else { "" };
            self.call("Input.dispatchKeyEvent", json!({"type": kind, "key": key, "code": code, "text": text}));
        }
    }

    /// Moves the mouse to a place in an element, as shares of its size.
    pub fn move_in(&mut self, selector: &str, x: f64, y: f64) -> [f64; 2] {
        let script = format!(
            "(() => {{ const b = document.querySelector({selector:?}).getBoundingClientRect(); \
             return [b.x + {x} * b.width, b.y + {y} * b.height]; }})()"
        );
        let [x, y]: [f64; 2] = serde_json::from_value(self.value(&script)).expect("a place");
        // Not exactly on the edge between two pixels of the image.
        let [x, y] = [x + 1.0, y + 1.0];
        self.call("Input.dispatchMouseEvent", json!({"type": "mouseMoved", "x": x, "y": y}));
        [x, y]
    }

    /// Clicks there.
    pub fn click_in(&mut self, selector: &str, x: f64, y: f64) {
        let [x, y] = self.move_in(selector, x, y);
        for kind in ["mousePressed", "mouseReleased"] {
            self.call(
                "Input.dispatchMouseEvent",
                json!({"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1}),
            );
        }
    }

    /// Keeps a picture of the window in the folder that ETENDUE_SCREENSHOTS names, where it names one.
    pub fn screenshot(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("ETENDUE_SCREENSHOTS") else { return };
        let answer = self.call("Page.captureScreenshot", json!({"format": "png"}));
        let data = answer["data"].as_str().expect("a picture");
        let bytes = base64::engine::general_purpose::STANDARD.decode(data).expect("base64");
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes).expect("a screenshot");
    }

    /// Asserts that the page threw nothing, complained of nothing, and asked for nothing but itself.
    pub fn assert_quiet(&mut self, page: &Path) {
        // What was under way is heard before this is answered.
        self.value("new Promise((done) => setTimeout(() => done(1), 100))");
        let own = format!("file://{}", page.display());
        for event in &self.events {
            let parameters = &event["params"];
            match event["method"].as_str().unwrap_or_default() {
                "Runtime.exceptionThrown" => panic!("the page threw: {parameters}"),
                "Runtime.consoleAPICalled" if parameters["type"] != "log" => panic!("the console says: {parameters}"),
                "Log.entryAdded" if parameters["entry"]["level"] == "error" => panic!("the log says: {parameters}"),
                "Network.requestWillBeSent" => {
                    let url = parameters["request"]["url"].as_str().unwrap_or_default();
                    assert!(url == own || url.starts_with("data:"), "the page asks for {url}");
                }
                _ => {}
            }
        }
        let is_loaded = |event: &&Value| event["method"] == "Network.requestWillBeSent";
        assert!(self.events.iter().any(|event| is_loaded(&event)), "requests are not heard of");
    }

    /// Sends a command and waits for its answer; events that come meanwhile are kept.
    fn call(&mut self, method: &str, params: Value) -> Value {
        self.number += 1;
        let mut message = json!({"id": self.number, "method": method, "params": params});
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.orders.write_all(&bytes).expect("the browser listens");
        loop {
            let message = self.messages.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("no answer to {method}"));
            if message["id"] == self.number {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].clone();
            }
            self.events.push(message);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
