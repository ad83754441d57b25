//! The head of the gallery: search, order, favorites, list or grid, and tags to choose.

use egui::{Button, RichText, Ui, vec2};

use super::arrange::Filter;
use crate::app::{
    settings::browsing::{Layout, Sort},
    widgets::{
        form::{menu_ui, search_ui},
        icons::{Icon, star_toggle, toggle_button},
        panel::at_right,
        theme,
    },
};

/// Tags that are seen before *more* is chosen.
const FEW_TAGS: usize = 7;

/// Shows the head of the gallery. `tags` are those of the listed presets, with their numbers.
pub fn toolbar_ui(
    ui: &mut Ui,
    filter: &mut Filter,
    layout: &mut Layout,
    shows_all_tags: &mut bool,
    tags: &[(String, usize)],
) {
    search_ui(ui, &mut filter.search, "Search presets");
    ui.horizontal(|ui| {
        let sorts = Sort::ALL.map(|sort| (sort, sort.label(), ""));
        let now = (filter.sort.label(), 112.0);
        if let (Some(sort), _) = menu_ui(ui, "Order of the presets", now, Some(&filter.sort), sorts)
        {
            filter.sort = sort;
        }
        at_right(ui, |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (icon, to, name) in [
                (Icon::Grid, Layout::Grid, "Large pictures"),
                (Icon::List, Layout::List, "List"),
            ] {
                if toggle_button(ui, icon, *layout == to, name)
                    .on_hover_text(name)
                    .clicked()
                {
                    *layout = to;
                }
            }
            star_toggle(ui, &mut filter.only_favorites, "Favorites only");
        });
    });
    tags_ui(ui, filter, shows_all_tags, tags);
}

fn tags_ui(ui: &mut Ui, filter: &mut Filter, shows_all: &mut bool, tags: &[(String, usize)]) {
    if tags.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        ui.spacing_mut().button_padding = vec2(7.0, 1.0);
        let count = if *shows_all {
            tags.len()
        } else {
            FEW_TAGS.max(filter.tags.len())
        };
        for (tag, number) in tags.iter().take(count) {
            let is_chosen = filter.tags.contains(tag);
            let text = RichText::new(tag).size(11.5).color(if is_chosen {
                theme::text_strong()
            } else {
                theme::text()
            });
            let fill = if is_chosen {
                theme::accent_ground()
            } else {
                theme::raised()
            };
            let chip = ui.add(
                Button::new(text)
                    .fill(fill)
                    .corner_radius(9.0)
                    .min_size(vec2(0.0, 18.0)),
            );
            let hint = if is_chosen {
                format!("Show presets without the tag {tag}, too")
            } else {
                format!("{number} listed presets have the tag {tag}")
            };
            if chip
                .on_hover_text(hint)
                .accessible_name(format!("Tag {tag}"))
                .clicked()
            {
                match is_chosen {
                    true => filter.tags.retain(|chosen| chosen != tag),
                    false => filter.tags.push(tag.clone()),
                }
            }
        }
        if tags.len() > FEW_TAGS {
            let text = if *shows_all {
                "fewer".to_owned()
            } else {
                format!("{} more", tags.len() - count.min(tags.len()))
            };
            let more = Button::new(theme::weak(text).size(11.5)).frame(false);
            if ui
                .add(more)
                .accessible_name(if *shows_all {
                    "Fewer tags"
                } else {
                    "More tags"
                })
                .clicked()
            {
                *shows_all = !*shows_all;
            }
        }
    });
}
