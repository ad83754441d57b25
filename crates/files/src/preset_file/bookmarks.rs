//! Bookmarks: a table `[bookmarks.NAME]` for each, with the keys of `[camera]`.

use toml_edit::{Item, Table, TableLike};

use super::{error::PresetError, read::read_section, reader::Reader, write::patch_settings};
use crate::preset::{
    Bookmark, MAX_BOOKMARKS, Preset, check_bookmark_name,
    settings::{BOOKMARKS, CAMERA},
};

/// A preset whose camera is that of a bookmark, which the settings of [`CAMERA`] read and write.
fn preset_of(bookmark: Option<&Bookmark>) -> Preset {
    Preset {
        camera: Some(bookmark.map(|mark| mark.camera).unwrap_or_default()),
        ..Preset::default()
    }
}

/// Reads `[bookmarks]`.
pub fn read(
    reader: &mut Reader<'_>,
    tables: &dyn TableLike,
    preset: &mut Preset,
) -> Result<(), PresetError> {
    let prefix = format!("{BOOKMARKS}.");
    for (name, _) in tables.iter() {
        let Some(table) = reader.table(tables, &prefix, name)? else {
            continue;
        };
        check_bookmark_name(name).map_err(|reason| reader.error(tables, &prefix, name, reason))?;
        if preset.bookmarks.len() == MAX_BOOKMARKS {
            let reason = format!("is one bookmark too many; a preset has at most {MAX_BOOKMARKS}");
            return Err(reader.error(tables, &prefix, name, reason));
        }
        let mut shown = preset_of(None);
        read_section(
            reader,
            table,
            &CAMERA,
            &format!("{prefix}{name}."),
            &mut shown,
        )?;
        preset.bookmarks.push(Bookmark {
            name: name.to_owned(),
            camera: shown.camera.unwrap_or_default(),
        });
    }
    Ok(())
}

/// Patches `root`, whose bookmarks are `saved`, so that they are `now`, in this order.
pub fn patch(root: &mut Table, saved: &[Bookmark], now: &[Bookmark]) {
    if saved == now {
        return;
    }
    if root.get(BOOKMARKS).is_none_or(|item| !item.is_table_like()) {
        let mut implicit = Table::new();
        implicit.set_implicit(true);
        root.insert(BOOKMARKS, Item::Table(implicit));
    }
    let Some(tables) = root.get_mut(BOOKMARKS).and_then(Item::as_table_like_mut) else {
        return;
    };
    // Every table is taken out and put back, so that they stand in the order of `now`.
    let mut before: Vec<(&Bookmark, Option<Item>)> = saved
        .iter()
        .map(|mark| (mark, tables.remove(&mark.name)))
        .collect();
    for mark in now {
        let old = before.iter_mut().find(|(old, _)| old.name == mark.name);
        let (saved, item) = old.map_or((None, None), |(old, item)| (Some(*old), item.take()));
        let mut item = item.unwrap_or_else(|| Item::Table(Table::new()));
        if let Some(table) = item.as_table_like_mut() {
            patch_settings(table, &CAMERA, &preset_of(saved), &preset_of(Some(mark)));
        }
        tables.insert(&mark.name, item);
    }
    if tables.is_empty() {
        root.remove(BOOKMARKS);
    }
}
