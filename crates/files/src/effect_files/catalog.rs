//! The catalog: the effects that a preset may name. The built-in ones, then those of files.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    error::{EffectError, Text},
    images::are_current,
    read::{MAX_SHARED_BYTES, check_name, decoded, read, read_beside, stem},
};
use crate::{
    effects::{EFFECTS, Effect},
    host::disk,
    params::did_you_mean,
};

/// An effect of a file: the effect, or what is wrong with the file.
#[derive(Clone, Debug, PartialEq)]
pub struct CustomEffect {
    /// The file; none for an effect that came inside a preset.
    pub path: Option<PathBuf>,
    pub read: Result<Arc<Effect>, EffectError>,
}

/// The effects that a preset may name. Clones share the list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Catalog {
    custom: Arc<BTreeMap<String, CustomEffect>>,
    /// Further instances of effects, under names of their own.
    instances: Arc<BTreeMap<String, Arc<Effect>>>,
}

impl Catalog {
    /// The built-in effects and those of the `.wgsl` files in these folders. Where two files have
    /// one name, the later folder wins.
    pub fn of_folders<'a>(folders: impl IntoIterator<Item = &'a Path>) -> Self {
        let mut catalog = Self::default();
        folders
            .into_iter()
            .for_each(|folder| catalog.add_folder(folder));
        catalog
    }

    /// Adds the files of a folder; a folder that does not exist has none.
    pub fn add_folder(&mut self, folder: &Path) {
        for path in files_of(folder) {
            self.add_file(&path);
        }
    }

    /// Adds the effect of one file, or what is wrong with it. A file whose text is known is not
    /// read anew.
    pub fn add_file(&mut self, path: &Path) {
        let (name, effect) = (stem(path), self.read_file(path));
        Arc::make_mut(&mut self.custom).insert(name, effect);
    }

    /// The effects of the files that are in these folders now. A file whose text is known here is
    /// not read anew. Where two files have one name, the later folder wins.
    #[must_use]
    pub fn reread<'a>(&self, folders: impl IntoIterator<Item = &'a Path>) -> Self {
        let paths: BTreeMap<String, PathBuf> = folders
            .into_iter()
            .flat_map(files_of)
            .map(|path| (stem(&path), path))
            .collect();
        let custom = paths
            .into_iter()
            .map(|(name, path)| (name, self.read_file(&path)))
            .collect();
        Self {
            custom: Arc::new(custom),
            instances: Arc::default(),
        }
    }

    /// These effects, with the effect of the same name in `earlier` in place of each faulty file.
    #[must_use]
    pub fn or_last_good(&self, earlier: &Self) -> Self {
        let mut custom = (*self.custom).clone();
        for (name, effect) in custom.iter_mut().filter(|(_, effect)| effect.read.is_err()) {
            if let Some(Ok(good)) = earlier.find_custom(name) {
                effect.read = Ok(good.clone());
            }
        }
        Self {
            custom: Arc::new(custom),
            ..self.clone()
        }
    }

    /// These effects, with the second of each pair in place of the first.
    #[must_use]
    pub fn replaced(&self, pairs: &[(Arc<Effect>, Arc<Effect>)]) -> Self {
        let mut replaced = self.clone();
        let customs = Arc::make_mut(&mut replaced.custom)
            .values_mut()
            .filter_map(|effect| effect.read.as_mut().ok());
        for effect in customs.chain(Arc::make_mut(&mut replaced.instances).values_mut()) {
            if let Some((_, new)) = pairs.iter().find(|(old, _)| effect == old) {
                *effect = new.clone();
            }
        }
        replaced
    }

    /// The instances, and the effects of files for which `is_kept` is true.
    #[must_use]
    pub fn only(&self, is_kept: impl Fn(&str, &CustomEffect) -> bool) -> Self {
        let kept = self
            .custom
            .iter()
            .filter(|(name, effect)| is_kept(name, effect));
        let custom = kept
            .map(|(name, effect)| (name.clone(), effect.clone()))
            .collect();
        Self {
            custom: Arc::new(custom),
            ..self.clone()
        }
    }

    /// These effects without the effects of files called `names` and without instances of them.
    #[must_use]
    pub fn without(&self, names: &[String]) -> Self {
        let is_named = |name: &str| names.iter().any(|named| named == name);
        let mut left = self.only(|name, _| !is_named(name));
        Arc::make_mut(&mut left.instances).retain(|_, effect| {
            effect
                .base
                .as_ref()
                .is_none_or(|base| !is_named(&base.name))
        });
        left
    }

    fn read_file(&self, path: &Path) -> CustomEffect {
        let name = stem(path);
        let file = path.display().to_string();
        let text = Text {
            file: &file,
            text: "",
        };
        let written = match disk::size_of(path) {
            Ok(None) => Err(text.whole("it is not a regular file")),
            Ok(Some(size)) if size > MAX_SHARED_BYTES as u64 => Err(text.whole(format!(
                "the file has {size} bytes; an effect has at most {MAX_SHARED_BYTES}",
            ))),
            Ok(Some(_)) => disk::read(path)
                .map_err(|error| text.whole(error.to_string()))
                .and_then(|bytes| decoded(&text, bytes)),
            Err(error) => Err(text.whole(error.to_string())),
        };
        let read = written.and_then(|written| match self.find_custom(&name) {
            Some(Ok(known))
                if known.source.as_ref().is_some_and(|source| {
                    source.written == written && are_current(source, path.parent())
                }) =>
            {
                Ok(known.clone())
            }
            _ => read_beside(&file, &name, &written, path.parent()),
        });
        CustomEffect {
            path: Some(path.to_owned()),
            read,
        }
    }

    /// Adds the text of an effect that came inside a preset.
    pub fn add_text(&mut self, stem: &str, written: &str) -> Result<(), EffectError> {
        let read = read(&format!("{stem}.wgsl"), stem, written);
        let error = read.clone().map(drop);
        Arc::make_mut(&mut self.custom).insert(stem.into(), CustomEffect { path: None, read });
        error
    }

    /// The text of the effect whose file is at `path`; none if there is none, or if it is faulty.
    pub fn written(&self, path: &Path) -> Option<&str> {
        let effect = self.custom.get(&stem(path))?;
        let is_of_file = effect.path.as_deref() == Some(path);
        let source = effect.read.as_ref().ok()?.source.as_ref()?;
        is_of_file.then_some(source.written.as_str())
    }

    /// The same with this effect in place of the one whose file is at `path`, if there is one.
    #[must_use]
    pub fn with_text_of(&self, path: &Path, effect: &Arc<Effect>) -> Self {
        let mut changed = self.clone();
        if let Some(custom) = Arc::make_mut(&mut changed.custom)
            .get_mut(&stem(path))
            .filter(|custom| custom.path.as_deref() == Some(path))
        {
            custom.read = Ok(effect.clone());
        }
        changed
    }

    /// These effects and those of `other`; where both have a name, this one's effect stays.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        let mut custom = (*other.custom).clone();
        custom.extend(
            self.custom
                .iter()
                .map(|(name, effect)| (name.clone(), effect.clone())),
        );
        let mut instances = (*other.instances).clone();
        instances.extend(
            self.instances
                .iter()
                .map(|(name, effect)| (name.clone(), effect.clone())),
        );
        Self {
            custom: Arc::new(custom),
            instances: Arc::new(instances),
        }
    }

    /// Adds another instance of the effect `base`, called `name`.
    ///
    /// # Errors
    /// Completes a sentence that begins with the name of the instance: no such effect, a faulty
    /// file, an effect that can stand in a stack only once, or a name that another effect has.
    pub fn add_instance(&mut self, name: &str, base: &str) -> Result<Arc<Effect>, String> {
        if let Some(known) = self
            .instances
            .get(name)
            .filter(|known| known.base.as_ref().is_some_and(|known| known.name == base))
        {
            return Ok(known.clone());
        }
        check_name(name)?;
        if self.custom.contains_key(name) {
            return Err("is the name of an effect file; choose another".into());
        }
        let found = self
            .find(base)
            .map_err(|error| format!("cannot be used: {error}"))?;
        let base = found
            .filter(|effect| effect.base.is_none())
            .ok_or_else(|| {
                format!(
                    "is an instance of {base:?}, which is no effect{}",
                    did_you_mean(base, self.names())
                )
            })?;
        if !base.has_instances() {
            return Err(format!(
                "is an instance of {}, which can stand in a stack only once",
                base.name
            ));
        }
        let effect = Arc::new(Effect::instance(name, base));
        Arc::make_mut(&mut self.instances).insert(name.into(), effect.clone());
        Ok(effect)
    }

    fn find_custom(&self, name: &str) -> Option<Result<&Arc<Effect>, &EffectError>> {
        self.custom.get(name).map(|custom| custom.read.as_ref())
    }

    /// The effect called `name`; none if there is no such effect.
    pub fn find(&self, name: &str) -> Result<Option<&Arc<Effect>>, &EffectError> {
        match Effect::find(name) {
            Some(effect) => Ok(Some(effect)),
            None => match self.instances.get(name) {
                Some(effect) => Ok(Some(effect)),
                None => self.find_custom(name).transpose(),
            },
        }
    }

    /// Every effect that can be used: the built-in ones in their order, then those of files and
    /// instances by name.
    pub fn effects(&self) -> impl Iterator<Item = &Arc<Effect>> {
        let custom = self
            .custom
            .values()
            .filter_map(|custom| custom.read.as_ref().ok());
        EFFECTS.iter().chain(custom).chain(self.instances.values())
    }

    /// Every effect of the catalog and of `used`, each name once, in the same order.
    pub fn effects_with<'a>(
        &'a self,
        used: impl Iterator<Item = &'a Arc<Effect>>,
    ) -> Vec<&'a Arc<Effect>> {
        let mut all: Vec<&Arc<Effect>> = self.effects().collect();
        for effect in used {
            if !all.iter().any(|known| known.name == effect.name) {
                all.push(effect);
            }
        }
        all[EFFECTS.len()..].sort_by(|a, b| a.name.cmp(&b.name));
        all
    }

    /// Names of all effects, those of faulty files included.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        EFFECTS.iter().map(|effect| effect.name.as_str()).chain(
            self.custom
                .keys()
                .chain(self.instances.keys())
                .map(String::as_str),
        )
    }

    /// Further instances of effects.
    pub fn instances(&self) -> impl Iterator<Item = &Arc<Effect>> {
        self.instances.values()
    }

    /// The effects of files, by name.
    pub fn custom(&self) -> impl Iterator<Item = (&str, &CustomEffect)> {
        self.custom
            .iter()
            .map(|(name, custom)| (name.as_str(), custom))
    }
}

/// The `.wgsl` files of a folder, sorted; none if there is no such folder.
fn files_of(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "wgsl")
            && path.is_file()
    });
    paths.sort();
    paths
}
