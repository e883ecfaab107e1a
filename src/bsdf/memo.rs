//! What is worked out once and remembered: tables and integrals of rough surfaces, by the parameters they depend on.

use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{LazyLock, Mutex, PoisonError};
use std::thread::LocalKey;

/// Results that all threads share, and beside them those that a thread has used: textures ask for them at every hit, where threads
/// must not wait for one another.
pub(super) struct Memo<K: 'static, V: 'static> {
    pub shared: &'static LazyLock<Mutex<HashMap<K, V>>>,
    pub own: &'static LocalKey<RefCell<HashMap<K, V>>>,
    /// Most results that are remembered. When there are more, all are forgotten.
    pub most: usize,
}

impl<K: Hash + Eq + Clone, V: Clone> Memo<K, V> {
    /// The result for a key, which `make` works out where it is not known. It must depend on the key alone.
    pub fn get(&self, key: &K, make: impl FnOnce() -> V) -> V {
        if let Some(found) = self.own.with_borrow(|own| own.get(key).cloned()) {
            return found;
        }
        let known = || self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().get(key).cloned();
        let result = found.unwrap_or_else(|| {
            let made = make();
            put(&mut known(), self.most, key, &made);
            made
        });
        self.own.with_borrow_mut(|own| put(own, self.most, key, &result));
        result
    }
}

fn put<K: Hash + Eq + Clone, V: Clone>(known: &mut HashMap<K, V>, most: usize, key: &K, value: &V) {
    if known.len() >= most {
        known.clear();
    }
    known.insert(key.clone(), value.clone());
}

/// Declares a memo of this name.
macro_rules! memo {
    ($(#[$doc:meta])* $name:ident: $key:ty => $value:ty, $most:expr) => {
        $(#[$doc])*
        static $name: $crate::bsdf::memo::Memo<$key, $value> = {
            type Known = std::collections::HashMap<$key, $value>;
            static SHARED: std::sync::LazyLock<std::sync::Mutex<Known>> = std::sync::LazyLock::new(Default::default);
            thread_local! {
                static OWN: std::cell::RefCell<Known> = std::cell::RefCell::default();
            }
            $crate::bsdf::memo::Memo { shared: &SHARED, own: &OWN, most: $most }
        };
    };
}
pub(super) use memo;
