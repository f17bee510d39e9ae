//! The parser: recursive descent over the tokens, one function per rule of the grammar.

use crate::ast::{
    Atom, Comparison, Condition, Expression, Law, Literal, Name, Operator, Shape, Sign, SortPart, Span,
    Statement,
};
use crate::lex::{Token, Word, words};
use crate::problem::{LanguageError, LanguageProblem};
use ramp_source::{Fault, SourceFile, nearest};

/// Words that begin or join statements, and so are not allowed as names.
pub(crate) const KEYWORDS: [&str; 13] = [
    "sort",
    "static",
    "inertial",
    "defined",
    "fluent",
    "exogenous",
    "action",
    "causes",
    "impossible",
    "if",
    "initially",
    "goal",
    "bridge",
];
/// Largest nesting depth of terms; the grammar needs two.
const DEPTH: usize = 16;

/// Parses a whole domain.
pub(crate) fn statements(file: &SourceFile) -> Result<Vec<Statement>, LanguageError> {
    let words = words(file)?;
    let mut parser = Parser { file, words, at: 0, anonymous: 0 };
    let mut statements = Vec::new();
    while parser.peek() != &Token::End {
        statements.push(parser.statement()?);
    }
    Ok(statements)
}

struct Parser<'a> {
    file: &'a SourceFile,
    words: Vec<Word>,
    at: usize,
    /// Number of `_` so far.
    anonymous: usize,
}

type Parsed<T> = Result<T, LanguageError>;

impl Parser<'_> {
    fn peek(&self) -> &Token {
        &self.words[self.at].what
    }

    fn span(&self) -> Span {
        self.words[self.at].span.clone()
    }

    /// Takes the next token, except the end.
    fn take(&mut self) -> Word {
        let word = self.words[self.at].clone();
        self.at = (self.at + 1).min(self.words.len() - 1);
        word
    }

    fn expected<T>(&self, expected: &str) -> Parsed<T> {
        let found = self.peek().describe();
        let similar = match self.peek() {
            Token::Name(name) if !KEYWORDS.contains(&name.as_str()) => nearest(name, KEYWORDS),
            _ => None,
        };
        let wanted = similar.filter(|keyword| expected.contains(&format!("`{keyword}`")));
        let nearest = wanted.map(str::to_string);
        let problem = LanguageProblem::Word { found, expected: expected.to_string(), nearest };
        Err(Fault::new(problem, self.file.place(self.span())))
    }

    fn is_sign(&self, sign: &str) -> bool {
        matches!(self.peek(), Token::Sign(found) if *found == sign)
    }

    fn is_keyword(&self, keyword: &str) -> bool {
        matches!(self.peek(), Token::Name(found) if found == keyword)
    }

    fn eat_sign(&mut self, sign: &str) -> bool {
        let there = self.is_sign(sign);
        if there {
            self.take();
        }
        there
    }

    fn eat_keyword(&mut self, keyword: &str) -> bool {
        let there = self.is_keyword(keyword);
        if there {
            self.take();
        }
        there
    }

    fn sign(&mut self, sign: &str, expected: &str) -> Parsed<()> {
        if self.eat_sign(sign) { Ok(()) } else { self.expected(expected) }
    }

    fn name(&mut self, expected: &str) -> Parsed<Name> {
        match self.peek() {
            Token::Name(name) if !KEYWORDS.contains(&name.as_str()) => {
                let text = name.clone();
                Ok(Name { text, span: self.take().span })
            }
            _ => self.expected(expected),
        }
    }

    fn statement(&mut self) -> Parsed<Statement> {
        let begin = self.span().start;
        let keyword = match self.peek() {
            Token::Name(name) => name.clone(),
            _ => String::new(),
        };
        let statement = match keyword.as_str() {
            "sort" => self.sort()?,
            "static" => {
                self.take();
                let (name, sorts) = self.declaration("the name of a static")?;
                Statement::Static { name, sorts }
            }
            "inertial" | "defined" => {
                self.take();
                if !self.eat_keyword("fluent") {
                    return self.expected("`fluent`");
                }
                let (name, sorts) = self.declaration("the name of a fluent")?;
                Statement::Fluent { name, sorts, inertial: keyword == "inertial" }
            }
            "exogenous" | "action" => {
                self.take();
                if keyword == "exogenous" && !self.eat_keyword("action") {
                    return self.expected("`action`");
                }
                let (name, sorts) = self.declaration("the name of an action")?;
                Statement::Action { name, sorts, exogenous: keyword == "exogenous" }
            }
            _ => {
                let law = self.law(&keyword)?;
                let body = if self.eat_keyword("if") { self.body()? } else { Vec::new() };
                Statement::Law { law, body, span: begin..self.span().start }
            }
        };
        let expected = match &statement {
            Statement::Law { body, .. } if body.is_empty() => "`if`, `causes` or `.`",
            Statement::Law { .. } => "`,` or `.`",
            _ => "`.`",
        };
        self.sign(".", expected)?;
        Ok(statement)
    }

    fn law(&mut self, keyword: &str) -> Parsed<Law> {
        Ok(match keyword {
            "impossible" => {
                self.take();
                Law::Impossible { action: self.atom("an action")? }
            }
            "initially" => {
                self.take();
                Law::Initially { head: self.literal("a fluent")? }
            }
            "goal" => {
                self.take();
                Law::Goal { head: self.literal("a fluent")? }
            }
            "bridge" => {
                self.take();
                Law::Bridge { head: self.atom("a coarse fluent")? }
            }
            _ => {
                let expected = "a declaration (`sort`, `static`, `inertial`, `defined`, `action`, `exogenous`) or a law \
                                (`impossible`, `initially`, `goal`, `bridge`, or the name of what it is about)";
                let head = self.literal(expected)?;
                if !self.is_keyword("causes") {
                    return Ok(Law::Holds { head });
                }
                if !head.positive {
                    return self.expected("`if` or `.`, because this begins with `-`");
                }
                self.take();
                let mut heads = vec![self.literal("a fluent")?];
                while self.eat_sign(",") {
                    heads.push(self.literal("a fluent")?);
                }
                Law::Causal { action: head.atom, heads }
            }
        })
    }

    fn sort(&mut self) -> Parsed<Statement> {
        self.take();
        let name = self.name("the name of a sort")?;
        if !self.eat_sign("=") {
            return Ok(Statement::Sort { name, parts: None });
        }
        let mut parts = Vec::new();
        loop {
            if self.eat_sign("{") {
                loop {
                    parts.push(SortPart::Constant(self.name("the name of a constant")?));
                    if !self.eat_sign(",") {
                        break;
                    }
                }
                self.sign("}", "`,` or `}`")?;
            } else {
                let name = self.name("the name of a sort, or `{`")?;
                parts.push(if self.eat_sign("(") {
                    SortPart::Function(name, self.sorts()?)
                } else {
                    SortPart::Sort(name)
                });
            }
            if !self.eat_sign("+") {
                return Ok(Statement::Sort { name, parts: Some(parts) });
            }
        }
    }

    /// Sorts up to the closing parenthesis.
    fn sorts(&mut self) -> Parsed<Vec<Name>> {
        let mut sorts = vec![self.name("the name of a sort")?];
        while self.eat_sign(",") {
            sorts.push(self.name("the name of a sort")?);
        }
        self.sign(")", "`,` or `)`")?;
        Ok(sorts)
    }

    fn declaration(&mut self, expected: &str) -> Parsed<(Name, Vec<Name>)> {
        let name = self.name(expected)?;
        let sorts = if self.eat_sign("(") { self.sorts()? } else { Vec::new() };
        Ok((name, sorts))
    }

    fn literal(&mut self, expected: &str) -> Parsed<Literal> {
        let positive = !self.eat_sign("-");
        Ok(Literal { positive, atom: self.atom(expected)? })
    }

    fn atom(&mut self, expected: &str) -> Parsed<Atom> {
        let name = self.name(expected)?;
        let arguments = if self.eat_sign("(") { self.arguments(0)? } else { Vec::new() };
        let span = name.span.start..self.before();
        Ok(Atom { name, arguments, span })
    }

    /// End of the last token.
    fn before(&self) -> usize {
        self.words[..self.at].last().map_or(0, |word| word.span.end)
    }

    fn arguments(&mut self, depth: usize) -> Parsed<Vec<Expression>> {
        let mut arguments = vec![self.expression(depth)?];
        while self.eat_sign(",") {
            arguments.push(self.expression(depth)?);
        }
        self.sign(")", "`,` or `)`")?;
        Ok(arguments)
    }

    fn body(&mut self) -> Parsed<Vec<Condition>> {
        let mut body = vec![self.condition()?];
        while self.eat_sign(",") {
            body.push(self.condition()?);
        }
        Ok(body)
    }

    fn condition(&mut self) -> Parsed<Condition> {
        // `-` begins a literal; a name begins a literal or a side of a comparison.
        if self.is_sign("-") {
            return Ok(Condition::Literal(self.literal("a fluent or a static")?));
        }
        let left = self.expression(0)?;
        let operator = match self.peek() {
            Token::Sign("=") => Operator::Equal,
            Token::Sign("!=") => Operator::NotEqual,
            Token::Sign("<") => Operator::Less,
            Token::Sign("<=") => Operator::LessEqual,
            Token::Sign(">") => Operator::Greater,
            Token::Sign(">=") => Operator::GreaterEqual,
            _ => {
                return match left.what {
                    Shape::Function(text, arguments) => {
                        let name = Name { span: left.span.start..left.span.start + text.len(), text };
                        let atom = Atom { name, arguments, span: left.span };
                        Ok(Condition::Literal(Literal { positive: true, atom }))
                    }
                    _ => self.expected("a comparison (`=`, `!=`, `<`, `<=`, `>`, `>=`)"),
                };
            }
        };
        self.take();
        Ok(Condition::Comparison(Comparison { left, operator, right: self.expression(0)? }))
    }

    fn expression(&mut self, depth: usize) -> Parsed<Expression> {
        let mut left = self.term(depth)?;
        for _ in 0..DEPTH {
            let sign = match self.peek() {
                Token::Sign("+") => Sign::Plus,
                Token::Sign("-") => Sign::Minus,
                _ => return Ok(left),
            };
            self.take();
            let right = self.term(depth)?;
            let span = left.span.start..right.span.end;
            left = Expression { what: Shape::Sum(Box::new(left), sign, Box::new(right)), span };
        }
        Err(Fault::new(LanguageProblem::Depth, self.file.place(self.span())))
    }

    fn term(&mut self, depth: usize) -> Parsed<Expression> {
        if depth > DEPTH {
            return Err(Fault::new(LanguageProblem::Depth, self.file.place(self.span())));
        }
        let begin = self.span().start;
        let what = match self.peek().clone() {
            Token::Variable(name) => {
                self.take();
                if name == "_" {
                    self.anonymous += 1;
                    Shape::Variable(format!("_{}", self.anonymous))
                } else if name.starts_with('_') {
                    self.at -= 1;
                    return self.expected("a variable, which begins with a capital letter, or `_`");
                } else {
                    Shape::Variable(name)
                }
            }
            Token::Number(number) => {
                self.take();
                Shape::Number(number)
            }
            Token::Quoted(name) => {
                self.take();
                Shape::Quoted(name)
            }
            _ => {
                let name = self.name("a term (a variable, a name or a number)")?;
                let arguments = if self.eat_sign("(") { self.arguments(depth + 1)? } else { Vec::new() };
                Shape::Function(name.text, arguments)
            }
        };
        Ok(Expression { what, span: begin..self.before() })
    }
}
