//! Lessons of which only some steps are given out. Begin with [`Lesson::with_steps`].

use crate::error::LessonError;
use crate::lesson::Lesson;

impl Lesson {
    /// Returns the text of a lesson that has only some steps of this one, in the order of this one; `text` is that of this
    /// lesson's file. Their runs and moments, questions, notes and names are the same.
    ///
    /// # Errors
    ///
    /// A name that no step has, with the names that there are.
    pub fn with_steps(&self, text: &str, names: &[String]) -> Result<String, LessonError> {
        let mut chosen = vec![false; self.steps.len()];
        for name in names {
            let found = self.step_named(name).ok_or_else(|| self.no_step(name))?;
            chosen[found] = true;
        }

        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines: Vec<&str> = text.lines().collect();
        // A step ends where the next one begins. Lines count from 1, so that `step.line - 1` is the index of the
        // step's title.
        let begins: Vec<usize> = self.steps.iter().map(|step| step.line - 1).collect();
        let ends = begins.iter().skip(1).copied().chain([lines.len()]);

        // The lesson has at least one step, before which stands the front matter.
        let mut kept: Vec<&str> = lines[..begins[0]].to_vec();
        // A step begins with the run of the step before it, so that the directives of steps that are left out still count.
        let mut runs: Vec<&str> = Vec::new();
        for ((&begin, end), is_chosen) in begins.iter().zip(ends).zip(chosen) {
            let section = &lines[begin..end];
            if is_chosen {
                kept.push(section[0]);
                kept.append(&mut runs);
                kept.extend(&section[1..]);
            } else {
                runs.extend(runs_of(section));
            }
        }

        // The last line ends, too.
        kept.push("");
        Ok(kept.join("\n"))
    }

    /// Returns the fault of a name that no step has.
    fn no_step(&self, name: &str) -> LessonError {
        let names: Vec<&str> = self.steps.iter().map(|step| step.name.as_str()).collect();
        LessonError::unknown(1, "step", name, &names)
    }
}

/// Returns the lines of the directives of runs in a step, with blank lines around each.
fn runs_of<'a>(section: &[&'a str]) -> Vec<&'a str> {
    let mut found = Vec::new();
    let mut lines = section.iter();
    while let Some(line) = lines.next() {
        let Some(info) = line.strip_prefix("```") else {
            continue;
        };

        // The lesson was read, so that each directive has an end.
        let directive: Vec<&str> = lines
            .by_ref()
            .copied()
            .take_while(|line| line.trim_end() != "```")
            .collect();

        // The reader of lessons (`read.rs`) allows more than three backticks before the kind of a directive. So does
        // this.
        if info.trim_start_matches('`').trim() == "run" {
            found.extend(["", line]);
            found.extend(directive);
            found.extend(["```", ""]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped;

    /// What a learner sees of a step: its texts, its run with the moment, and its question; without lines of the file, which
    /// differ.
    fn seen(lesson: &Lesson, name: &str) -> String {
        let step = &lesson.steps[lesson.step_named(name).expect("the step")];
        let scene = &step.scene;
        let gate = step.gate.as_ref();
        let all = format!(
            "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
            (&step.title, &step.text, &step.after, &step.notes),
            (scene.parameters, &scene.moment, &scene.condition),
            (scene.levels, &scene.density, &scene.radius, scene.has_coin),
            (scene.depth, &scene.plane),
            (&scene.layers, &scene.camera),
            gate.map(|gate| (&gate.name, &gate.ask, gate.kind_name, &gate.wrong)),
            gate.map(|gate| (&gate.hint, &gate.mark, gate.circle, gate.strip)),
            gate.map(|gate| (&gate.decided, &gate.shows, &gate.otherwise)),
            gate.map(|gate| (&gate.because, gate.is_reading, gate.concept)),
            gate.map(|gate| &gate.practice),
            lesson.form,
        );
        let mut pieces = all.split("line: ");
        let first = pieces.next().unwrap_or_default().to_owned();
        let rest = pieces.map(|piece| piece.trim_start_matches(|c: char| c.is_ascii_digit()));
        rest.fold(first, |all, piece| all + piece)
    }

    #[test]
    fn a_step_alone_has_the_run_and_the_question_that_it_has_in_its_lesson() {
        for shipped in shipped::all() {
            let whole = Lesson::read(&shipped.name, &shipped.text).unwrap();
            for step in &whole.steps {
                let text = whole.with_steps(&shipped.text, std::slice::from_ref(&step.name));
                let part = Lesson::read(&shipped.name, &text.unwrap()).unwrap();
                assert_eq!(part.steps.len(), 1);
                assert_eq!(seen(&part, &step.name), seen(&whole, &step.name));
            }
        }
    }

    #[test]
    fn steps_stand_in_the_order_of_their_lesson_and_unknown_names_are_refused() {
        let all = shipped::lessons();
        let survivors = all.iter().find(|one| one.name == "survivors").unwrap();
        let whole = Lesson::read("survivors", &survivors.text).unwrap();
        let names = ["chain", "too-close"].map(str::to_owned);
        let text = whole.with_steps(&survivors.text, &names).unwrap();
        let part = Lesson::read("survivors", &text).unwrap();
        let order: Vec<&str> = part.steps.iter().map(|step| &*step.name).collect();
        assert_eq!(order, ["too-close", "chain"]);
        assert_eq!((&part.title, part.minutes), (&whole.title, whole.minutes));

        // The run of the chain has its own radius and takes the rest from a step that is left out.
        assert_ne!(seen(&part, "chain"), seen(&part, "too-close"));
        let wrong = whole.with_steps(&survivors.text, &["chian".to_owned()]);
        let said = wrong.unwrap_err().message;
        assert!(said.contains("chian") && said.contains("chain"), "{said}");
    }
}
