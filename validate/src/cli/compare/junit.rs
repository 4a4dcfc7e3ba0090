//! The report as JUnit XML: a test case a cell.

use super::{Report, words};
use dacrt_validate::compare::Grade;
use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};

/// Regressions are failures, cells of one file only are skipped; what else has changed stands in
/// the output of its cell.
pub fn junit(report: &Report) -> anyhow::Result<String> {
    let comparison = &report.comparison;
    let mut suite = TestSuite::new("dacrt compare");
    suite.add_property(("reference", words::origin(&comparison.reference).as_str()));
    suite.add_property(("new", words::origin(&comparison.new).as_str()));
    for (i, reason) in words::not_judged(comparison).iter().enumerate() {
        suite.add_property((format!("not judged {}", i + 1).as_str(), reason.as_str()));
    }
    for cell in &comparison.cells {
        let lines = words::lines(cell);
        let is_regression = cell.grade == Grade::Regression;
        let status = if is_regression {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_type("regression");
            status.set_message(lines.first().map_or("", String::as_str));
            status.set_description(lines.join("\n"));
            status
        } else {
            TestCaseStatus::success()
        };
        let mut case = TestCase::new(cell.name.as_str(), status);
        case.set_classname("dacrt compare");
        if !is_regression && !lines.is_empty() {
            case.set_system_out(lines.join("\n"));
        }
        suite.add_test_case(case);
    }
    for (names, which) in [
        (&comparison.only_in_reference, "only in the reference"),
        (&comparison.only_in_new, "only in the new file"),
    ] {
        for name in names {
            let mut status = TestCaseStatus::skipped();
            status.set_message(which);
            let mut case = TestCase::new(name.as_str(), status);
            case.set_classname("dacrt compare");
            suite.add_test_case(case);
        }
    }
    let mut xml = quick_junit::Report::new("dacrt");
    xml.add_test_suite(suite);
    Ok(xml.to_string()?)
}
