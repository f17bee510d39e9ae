//! Explanation of a page's numbers.

use maud::{Markup, html};

use ramp_result::statistics::{DRAWS, FLIPS, SEED};

/// Explanation of the numbers.
pub fn method() -> Markup {
    html! {
        h2 { "How the numbers are made" }
        p {
            "Completion of an episode is pegs that count / pegs in the goal; the mean is over episodes, and a lost episode \
             (crashed, killed, or out of time on the wall) counts as one without pegs. Means of time are over the episodes \
             that have a result, complete or not."
        }
        p {
            "The pegs of an episode are not independent: where one is not seated, later ones often cannot be. So no interval \
             is made from pegs; the unit is the episode. " strong { "Complete" } " is the number of episodes with every peg \
             and Wilson's interval of their share. " strong { "Completion" } " and " strong { "times" } " have a percentile \
             bootstrap of " (DRAWS) " draws of episodes, each goal from its own, for the goals are chosen and not sampled. \
             Where all episodes are complete, or none has a peg, a bootstrap can draw nothing else; then the interval is \
             Wilson's of the share of such episodes, which is wider than the truth on the safe side. With five repeats of a \
             goal all these intervals are rough."
        }
        p {
            strong { "Comparisons" } " pair episodes of one goal and seed: two-sided sign-flip (paired permutation) test of \
             the mean difference, exact up to 20 pairs that differ, else of " (FLIPS) " draws. The corrected p is Holm's, \
             over all tests of this report; “differs” is below 0.05. All draws come from named streams of the seed " (SEED)
            ": the same results give the same report to the last bit."
        }
        p {
            "Robot time is cut by the events of a result: an action begins with " code { "action_begun" } " and ends with "
            code { "action_ended" } ", or where the next one starts. Time outside actions, and all time of an agent that tells no \
             events, is “between actions”."
        }
    }
}
