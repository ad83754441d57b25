//! Pace: how long a measurement takes. Before it begins this is a guess from the picture and from
//! earlier measurements; each step that is done corrects the guess.

/// One kind of step: how many there are, how many are done, and how long each takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Steps {
    all: usize,
    done: usize,
    spent_s: f64,
    /// Seconds for each, before any is done.
    guess_s: f64,
}

impl Steps {
    const fn new(all: usize, guess_s: f64) -> Self {
        Self {
            all,
            done: 0,
            spent_s: 0.0,
            guess_s,
        }
    }

    fn each_s(&self) -> f64 {
        if self.done == 0 {
            self.guess_s
        } else {
            self.spent_s / self.done as f64
        }
    }

    fn left_s(&self) -> f64 {
        self.all.saturating_sub(self.done) as f64 * self.each_s()
    }

    fn add(&mut self, passed_s: f64) {
        self.done = (self.done + 1).min(self.all.max(1));
        self.spent_s += passed_s;
    }
}

/// The kinds of steps of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Kind {
    /// The oracle draws the reference pictures.
    Reference,
    /// A combination is compiled, drawn and judged.
    SetUp,
    /// A combination is drawn and timed.
    Time,
}

/// How long a measurement takes, and how much of it is done.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pace {
    steps: [Steps; 3],
}

/// What is known of a machine, from a measurement that was made on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// The oracle's reference pictures, seconds for a million pixels.
    pub reference_s: f64,
    /// Compiling, drawing and judging a combination: seconds for each, and seconds more for a
    /// million pixels.
    pub compile_s: f64,
    pub judge_s: f64,
    /// Time of a sample over the time of a frame: two frames are drawn for each sample, and the
    /// device is waited for.
    pub frames: f64,
}

impl Default for Rates {
    /// Two cores without a graphics card.
    fn default() -> Self {
        Self {
            reference_s: 3.0,
            compile_s: 0.5,
            judge_s: 6.0,
            frames: 2.5,
        }
    }
}

impl Pace {
    /// The pace of a measurement of `combinations`, each drawn `samples` times, of a picture of
    /// `pixels` that takes `frame_ms`; the oracle draws as many reference pixels as
    /// `reference_pixels` says.
    pub fn of(
        combinations: usize,
        samples: usize,
        pixels: f64,
        reference_pixels: f64,
        frame_ms: f64,
        rates: &Rates,
    ) -> Self {
        let reference = Steps::new(1, rates.reference_s * reference_pixels / 1e6);
        let set_up = Steps::new(combinations, rates.compile_s + rates.judge_s * pixels / 1e6);
        let time = Steps::new(combinations * samples, rates.frames * frame_ms / 1e3);
        Self {
            steps: [reference, set_up, time],
        }
    }

    /// A step of this kind was done in so many seconds.
    pub fn add(&mut self, kind: Kind, passed_s: f64) {
        self.steps[kind as usize].add(passed_s);
    }

    /// Some combinations cannot be drawn: so many steps of this kind there are.
    pub fn expect(&mut self, kind: Kind, all: usize) {
        self.steps[kind as usize].all = all;
    }

    /// Was a step of this kind done?
    #[cfg(target_arch = "wasm32")]
    pub const fn has_done(&self, kind: Kind) -> bool {
        self.steps[kind as usize].done > 0
    }

    /// Seconds that are left.
    pub fn left_s(&self) -> f64 {
        self.steps.iter().map(Steps::left_s).sum()
    }

    /// The part of the time that has passed, 0 to 1.
    pub fn fraction(&self) -> f64 {
        let spent: f64 = self.steps.iter().map(|steps| steps.spent_s).sum();
        if spent > 0.0 {
            spent / (spent + self.left_s())
        } else {
            0.0
        }
    }

    /// What this measurement of a picture of `pixels` has taught; `before` where it has not come so
    /// far.
    pub fn rates(
        &self,
        pixels: f64,
        reference_pixels: f64,
        frame_ms: f64,
        before: &Rates,
    ) -> Rates {
        let [reference, set_up, time] = &self.steps;
        let mpx = (pixels / 1e6).max(1e-6);
        let measured = |steps: &Steps, known: f64, of: &dyn Fn(f64) -> f64| {
            if steps.done > 0 {
                of(steps.each_s())
            } else {
                known
            }
        };
        // How the time of setting up is shared out between compiling and judging is not known; the
        // ratio stays.
        let guessed = before.compile_s + before.judge_s * mpx;
        let scale = measured(set_up, 1.0, &|each_s| each_s / guessed.max(1e-9));
        Rates {
            reference_s: measured(reference, before.reference_s, &|each_s| {
                each_s / (reference_pixels / 1e6).max(1e-6)
            }),
            compile_s: before.compile_s * scale,
            judge_s: before.judge_s * scale,
            frames: measured(time, before.frames, &|each_s| {
                1e3 * each_s / frame_ms.max(1e-3)
            }),
        }
    }
}

/// `about 40 s`, `about 3 min`: seconds as a person wants to know them.
pub fn about(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => "a long time".into(),
        s if s < 1.5 => "about 1 s".into(),
        s if s < 10.0 => format!("about {s:.0} s"),
        s if s < 100.0 => format!("about {:.0} s", (s / 5.0).round() * 5.0),
        s if s < 5400.0 => format!("about {:.0} min", s / 60.0),
        s => format!("about {:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATES: Rates = Rates {
        reference_s: 2.0,
        compile_s: 0.5,
        judge_s: 1.0,
        frames: 2.0,
    };

    #[test]
    fn a_guess_is_the_sum_of_its_steps() {
        let pace = Pace::of(6, 30, 1e6, 3e6, 10.0, &RATES);
        assert!(
            (pace.left_s() - (6.0 + 6.0 * 1.5 + 180.0 * 0.02)).abs() < 1e-9,
            "{}",
            pace.left_s()
        );
        assert_eq!(pace.fraction(), 0.0);
    }

    #[test]
    fn what_is_left_follows_what_was_measured() {
        let mut pace = Pace::of(4, 10, 1e6, 1e6, 10.0, &RATES);
        pace.add(Kind::Reference, 5.0);
        pace.add(Kind::SetUp, 3.0);
        // Three more combinations at 3 s, and 40 samples at the guess of 20 ms.
        assert!(
            (pace.left_s() - (9.0 + 0.8)).abs() < 1e-9,
            "{}",
            pace.left_s()
        );
        assert!((pace.fraction() - 8.0 / 17.8).abs() < 1e-9);
        (0..3).for_each(|_| pace.add(Kind::SetUp, 3.0));
        (0..40).for_each(|_| pace.add(Kind::Time, 0.1));
        assert_eq!((pace.left_s(), pace.fraction()), (0.0, 1.0));
    }

    #[test]
    fn the_next_guess_is_what_this_measurement_took() {
        let mut pace = Pace::of(2, 2, 2e6, 4e6, 10.0, &RATES);
        pace.add(Kind::Reference, 12.0);
        (0..2).for_each(|_| pace.add(Kind::SetUp, 7.5));
        (0..4).for_each(|_| pace.add(Kind::Time, 0.05));
        let learned = pace.rates(2e6, 4e6, 10.0, &RATES);
        let next = Pace::of(2, 2, 2e6, 4e6, 10.0, &learned);
        assert!(
            (next.left_s() - (12.0 + 15.0 + 0.2)).abs() < 1e-9,
            "{}",
            next.left_s()
        );
        assert_eq!(
            Pace::of(2, 2, 2e6, 4e6, 10.0, &RATES).rates(2e6, 4e6, 10.0, &RATES),
            RATES,
            "nothing was measured"
        );
    }

    #[test]
    fn seconds_are_rounded_as_people_say_them() {
        assert_eq!(
            [0.2, 4.4, 42.0, 150.0, 9000.0].map(about),
            [
                "about 1 s",
                "about 4 s",
                "about 40 s",
                "about 2 min",
                "about 2.5 h"
            ]
        );
    }
}
