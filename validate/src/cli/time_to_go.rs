//! How long the rest of a run will take.

/// An estimate from the batches measured so far. A batch is worth its rays times its contestants;
/// what a unit of that takes differs by scene and ray type, so the estimate is a range: as if all
/// that is left were like the fastest batch so far, or like the slowest.
#[derive(Clone, Debug)]
pub struct TimeToGo {
    /// Of the batches that are left.
    work: f64,
    /// Least and greatest seconds that a unit of work took.
    rates: Option<[f64; 2]>,
}

impl TimeToGo {
    /// Nothing is done yet of so much work.
    pub fn new(work: f64) -> TimeToGo {
        TimeToGo { work, rates: None }
    }

    /// A batch need not be measured.
    pub fn skip(&mut self, work: f64) {
        self.work -= work;
    }

    /// A batch was measured.
    pub fn measured(&mut self, work: f64, seconds: f64) {
        self.work -= work;
        let rate = seconds / work;
        let [least, greatest] = self.rates.unwrap_or([rate; 2]);
        self.rates = Some([least.min(rate), greatest.max(rate)]);
    }

    /// Such as `2 to 5 min to go`; empty as long as nothing is known, or if nothing is left.
    pub fn text(&self) -> String {
        let Some(rates) = self.rates else {
            return String::new();
        };
        let [least, greatest] = rates.map(|rate| (rate * self.work).max(0.0));
        if self.work <= 0.0 || greatest < 0.5 {
            return String::new();
        }
        let (unit, name) = match greatest {
            ..=90.0 => (1.0, "s"),
            ..=5400.0 => (60.0, "min"),
            _ => (3600.0, "h"),
        };
        let [least, greatest] = [least, greatest].map(|s| {
            let n = s / unit;
            format!("{n:.0$}", usize::from(n < 9.5 && unit > 1.0))
        });
        match least == greatest {
            true => format!("about {greatest} {name} to go"),
            false => format!("{least} to {greatest} {name} to go"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_said_before_anything_is_known() {
        let mut time = TimeToGo::new(10.0);
        assert_eq!(time.text(), "");
        time.skip(4.0);
        assert_eq!(time.text(), "");
        time.measured(2.0, 20.0);
        assert_eq!(time.text(), "about 40 s to go");
        time.measured(4.0, 1.0);
        assert_eq!(time.text(), "");
    }

    #[test]
    fn the_range_is_from_the_fastest_to_the_slowest_batch() {
        let mut time = TimeToGo::new(110.0);
        time.measured(5.0, 50.0);
        time.measured(5.0, 10.0);
        assert_eq!(time.text(), "3.3 to 17 min to go");
        // Batches as seen before take no more and no less than said.
        time.measured(50.0, 200.0);
        assert_eq!(time.text(), "1.7 to 8.3 min to go");
    }

    #[test]
    fn batches_of_a_resumed_run_say_nothing_of_time() {
        let mut time = TimeToGo::new(100.0);
        time.skip(90.0);
        time.measured(1.0, 3600.0);
        assert_eq!(time.text(), "about 9.0 h to go");
    }
}
