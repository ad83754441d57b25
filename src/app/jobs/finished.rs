//! Taking in what jobs have finished.

use eframe::egui;

use super::Done;
use crate::app::{
    editing::new_effect,
    files::{
        apply::save_failed,
        command::Purpose,
        library, open,
        reload::{code_tried, compiled, model_reloaded},
    },
    panels::Panels,
    picture::{
        apply::draw_for_review, cells::CellOf, findings::Findings, measured::error_text,
        screen::Inputs, tier_times, verification::Verdict,
    },
    shell::{command::Commands, log::Level, state::State},
};
#[cfg(target_arch = "wasm32")]
use crate::app::{files::take_along, shell::input};

/// Takes in the result of a job.
pub fn finish(
    ctx: &egui::Context,
    state: &mut State,
    panels: &mut Panels,
    commands: &Commands,
    done: Done,
) {
    match done {
        Done::Scene(key, Ok(scene)) => {
            for note in &scene.notes {
                state
                    .log
                    .add(Level::Warning, format!("{}: {note}", scene.name));
            }
            model_reloaded(state, &key, Ok(()));
            state.session.scenes.arrived(key.clone(), Some(scene));
            open::scene_arrived(state, panels, &key, true);
        }
        Done::Scene(key, Err(error)) => {
            if open::scene_arrived(state, panels, &key, false) {
                state.session.scenes.abandon(&key);
                return state.notify(Level::Error, error);
            }
            let is_again = model_reloaded(state, &key, Err(&error));
            state.session.scenes.arrived(key, None);
            if !is_again {
                state.notify(Level::Error, error);
            }
        }
        Done::Canceled => {}
        Done::SceneBox(source, bounds) => open::bounds_arrived(state, panels, source, bounds),
        Done::Verdict(inputs, work, findings) => {
            if state.picture.verification.ended(&work) {
                verdict(state, panels, *inputs, findings);
            }
        }
        Done::Trade(points) => {
            let timed = points.as_ref().map_or(0, |points| {
                points.iter().filter(|point| point.ms.is_some()).count()
            });
            match panels.trade.arrived(points) {
                Some(error) => state.log.add(Level::Error, error),
                None if timed > 0 => state.log.add(
                    Level::Info,
                    format!("Trade: combinations measured: {timed}"),
                ),
                None => {}
            }
        }
        Done::Cell(CellOf::Sweep { number, index }, picture) => {
            panels.sweep.arrived(ctx, (number, index), picture)
        }
        Done::Cell(CellOf::Seed(seed), picture) => panels.randomize.arrived(ctx, seed, picture),
        Done::Thumbnail(id, image) => panels.browser.pictures.arrived(ctx, &id, image),
        Done::ThumbnailOn(key, id, image) => panels
            .browser
            .pictures
            .on_model_arrived(ctx, &key, &id, image),
        Done::EffectPicture(effect, image) => {
            panels.browser.effects.picture_arrived(ctx, &effect, image)
        }
        Done::Favorites(outcome) => {
            state.files.favorites.write_ended();
            match outcome {
                Ok(()) => library::write_favorites(state),
                Err(error) => state.notify(Level::Error, error),
            }
        }
        Done::Export(path, Ok(())) => {
            state.notify(Level::Info, format!("Saved {}", path.display()))
        }
        Done::Film(progress, ended) => {
            if let Some((level, text)) = panels.film.arrived(&progress, ended) {
                state.notify(level, text);
            }
        }
        Done::Export(path, Err(error)) => save_failed(state, panels, Purpose::Export, &path, error),
        Done::Compiled(reload, outcome) => compiled(state, panels, reload, outcome),
        Done::Precision(of, measured) => {
            if let Some(error) = state.picture.precision.arrived(*of, measured) {
                state.log.add(Level::Error, error);
            }
        }
        Done::TierTime(timed) => tier_times::arrived(state, *timed),
        Done::Golden(number, check) => {
            if state.files.live.checking_golden == Some(number) {
                state.files.live.checking_golden = None;
                state.files.live.golden = check;
            }
        }
        Done::Reviewed(name, drawn) => {
            state.picture.review.drawn(&name, drawn);
            draw_for_review(state);
        }
        Done::Blessed(name, outcome) => {
            state.picture.review.blessed(&name, outcome.is_ok());
            match outcome {
                Ok(()) => state.notify(Level::Info, format!("Accepted the golden of {name}")),
                Err(error) => state.notify(Level::Error, error),
            }
            draw_for_review(state);
        }
        Done::EffectWritten(path, origin, outcome) => {
            let is_written = outcome.is_ok();
            new_effect::written(state, panels, path.clone(), origin, outcome);
            if is_written {
                state.jobs.read_code(path);
            }
        }
        Done::Probed(Ok(probed)) => state.picture.probed = Some(*probed),
        Done::Probed(Err(error)) => state.notify(Level::Error, error),
        Done::Code(path, Ok(text)) => panels.code.show(path, text),
        Done::CodeTried(path, text, read) => {
            panels.code.take_error(&text, read.as_ref().err());
            code_tried(state, panels, &path, read);
        }
        Done::CodeSaved(path, text, Ok(())) => panels.code.take_saved(&path, &text),
        Done::Code(_, Err(error)) | Done::CodeSaved(_, _, Err(error)) => {
            state.notify(Level::Error, error)
        }
        Done::NoEditor(path, reason) => {
            let text = format!(
                "{} could not be opened in an editor: {reason}",
                path.display()
            );
            state.notify(Level::Warning, text);
        }
        Done::Link(link, why) => {
            ctx.copy_text(link);
            let why = why.map_or_else(String::new, |why| {
                format!("; its picture is judged there, but not bit by bit: {why}")
            });
            state.notify(Level::Info, format!("Copied the link to a page{why}"));
        }
        #[cfg(target_arch = "wasm32")]
        Done::Given(Ok(given)) if given.is_export => take_along::import(ctx, state, commands),
        #[cfg(target_arch = "wasm32")]
        Done::Given(Ok(given)) => input::open_given(given.paths, commands),
        #[cfg(target_arch = "wasm32")]
        Done::Given(Err(error)) => state.notify(Level::Error, error),
        Done::Path(purpose, answer) => {
            panels
                .dialogs
                .path_arrived(purpose, answer, &state.session.preset_file, commands)
        }
        Done::Folder(listing) => panels.dialogs.folder_arrived(listing),
        Done::Missing(files) => state.files.missing_files = files,
    }
}

/// Keeps the verdict of the oracle on `of`: for A, for B, or for both if they are the same picture.
fn verdict(
    state: &mut State,
    panels: &mut Panels,
    of: Inputs,
    findings: Result<Option<Box<Findings>>, String>,
) {
    match findings {
        // Overlays do not begin it again.
        Ok(None) => state.picture.verification.fail(of),
        Ok(Some(findings)) => {
            state.log.add(
                Level::Info,
                format!(
                    "verified {}: {}",
                    state.session.title(),
                    error_text(&findings)
                ),
            );
            let verdict = Verdict {
                of,
                findings: findings.into(),
            };
            tier_times::judge(state, &verdict);
            if !panels.viewport.compare.take_verdict(&verdict)
                || state.picture.screen.requested() == Some(&verdict.of)
            {
                state.picture.verification.set(verdict);
            }
        }
        Err(error) => {
            state.notify(Level::Error, error);
            state.picture.verification.fail(of);
        }
    }
}
